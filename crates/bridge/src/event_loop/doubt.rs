//! Channels that are off inside their range: how long they hold anything, and when the pad plays again.

use super::virtual_time::Play;
use tactpad_core::quantity::Contact;

/// A channel that is off holds nothing for longer: the block in which it begins, and a whole one.
const HELD_MAX_MS: u64 = 250;

const AWAY: Contact = Contact { x_mm: 0.0, y_mm: 0.0, fx_n: 0.0, fy_n: 0.0, fz_n: 0.0 };

/// To the right, and with the force that presses the button.
const FIRM: Contact = Contact { x_mm: 15.0, y_mm: 6.0, fx_n: 0.3, fy_n: 0.0, fz_n: 3.0 };

const LIGHT: Contact = Contact { fx_n: 0.0, fz_n: 0.6, ..FIRM };

/// A channel that stands at so many millivolts, with noise of so many microvolts either way, whatever presses.
fn rail(channel: usize, mv: i32, noise_uv: i32) -> impl Fn(u32, &mut [i32; 9]) + Clone {
    move |number, counts| {
        let noise = (number.wrapping_mul(2_654_435_761) >> 16) as i32 % (200 * noise_uv + 1) - 100 * noise_uv;
        counts[channel] = 100_000 * mv + noise;
    }
}

/// A channel that reads what another one does.
fn short(channel: usize, to: usize) -> impl Fn(u32, &mut [i32; 9]) {
    move |_, counts| counts[channel] = counts[to] + (counts[channel] & 1)
}

/// For how long from now on anything is held while a contact is kept for so long, at the latest, in ms.
fn held_ms(play: &mut Play, contact: &Contact, ms: u64) -> u64 {
    let is_held = |play: &mut Play| {
        play.touch(contact, 1);
        play.bridge.driver.pipeline.held().next().is_some()
    };
    (1..=ms).filter(|_| is_held(play)).last().unwrap_or(0)
}

/// A fault that comes under a finger which stays for a while, then while nothing is held, and ends in between and after it.
fn plays_around(name: &str, finger: &Contact, wiring: impl Fn(u32, &mut [i32; 9]) + Clone + 'static) {
    let mut play = Play::start();
    assert!(held_ms(&mut play, finger, 300) > 0, "{name}: it plays");
    play.wiring = Box::new(wiring.clone());
    let under_ms = held_ms(&mut play, finger, 500);
    // Beside a light finger a channel reads by itself, which is its zero then: the finger plays on without it.
    assert!(under_ms <= HELD_MAX_MS || *finger == LIGHT, "{name}: under the finger {under_ms} ms");
    let lifted_ms = held_ms(&mut play, &AWAY, 600);
    assert!(lifted_ms <= HELD_MAX_MS, "{name}: after it was lifted {lifted_ms} ms");
    is_over(name, &mut play);
    play.wiring = Box::new(wiring);
    let idle_ms = held_ms(&mut play, &AWAY, 1_000);
    assert!(idle_ms <= HELD_MAX_MS, "{name}: without a finger {idle_ms} ms");
    is_over(name, &mut play);
}

/// It ends: half a second later a press counts, and is let go.
fn is_over(name: &str, play: &mut Play) {
    play.wiring = Box::new(|_, _| ());
    let over_ms = held_ms(play, &AWAY, 400);
    assert!(over_ms <= HELD_MAX_MS, "{name}: when it is over {over_ms} ms");
    let pressed = play.touch(&FIRM, 100);
    assert!(pressed.iter().any(|(_, value, _)| *value != 0), "{name}: {pressed:?}");
    play.touch(&AWAY, 60);
    assert!(play.bridge.driver.pipeline.held().next().is_none(), "{name}: something stays down");
}

#[test]
fn a_channel_at_a_rail_inside_its_range_holds_nothing() {
    for channel in 0..9 {
        let (mv, finger) = [(15, FIRM), (-15, LIGHT), (15, LIGHT), (-15, FIRM)][channel % 4];
        plays_around(&format!("channel {channel} at {mv} mV"), &finger, rail(channel, mv, 200));
    }
}

#[test]
fn two_channels_at_rails_hold_nothing_once_the_finger_is_away() {
    for (one, other, mv) in [(2, 5, 15), (2, 4, -12), (0, 8, 9), (1, 7, 15)] {
        let name = format!("channels {one} and {other} at {mv} mV");
        let (first, second) = (rail(one, mv, 200), rail(other, 15, 90));
        let mut play = Play::start();
        play.touch(&FIRM, 300);
        play.wiring = Box::new(move |number, counts| {
            first(number, counts);
            second(number, counts);
        });
        play.touch(&FIRM, 300);
        let lifted_ms = held_ms(&mut play, &AWAY, 1_000);
        assert!(lifted_ms <= HELD_MAX_MS, "{name}: {lifted_ms} ms");
        is_over(&name, &mut play);
    }
}

#[test]
fn a_channel_that_follows_another_one_holds_nothing_once_the_finger_is_away() {
    for (channel, to) in [(2, 5), (5, 2), (8, 2), (2, 1), (5, 4)] {
        let mut play = Play::start();
        play.touch(&FIRM, 300);
        play.wiring = Box::new(short(channel, to));
        play.touch(&FIRM, 400);
        let lifted_ms = held_ms(&mut play, &AWAY, 400);
        assert!(lifted_ms <= 50, "{channel} like {to}: {lifted_ms} ms");
        is_over("short", &mut play);
    }
}
