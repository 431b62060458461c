//! What the player does over time, and the events that a correct bridge makes of it.

use crate::pipeline::control::{Code, OutputDevice};
use crate::pipeline::mapping::profile::Profile;
use crate::quantity::Contact;
use crate::virtual_pad::gesture::Gesture;
use crate::virtual_pad::repertoire::gestures;

/// Nothing touches the pad this long after the start, so that the bridge can find the channels' zero.
pub const REST_AT_START_US: u64 = 600_000;

/// Nothing touches the pad this long before the end.
pub const REST_AT_END_US: u64 = 300_000;

/// A longer script plays this long and then rests: 24 hours.
pub const DURATION_MAX_US: u64 = 86_400_000_000;

/// A contact at a moment. Between two keyframes the contact moves smoothly, starting and stopping at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Keyframe {
    /// Script time, in microseconds from the start.
    pub at_us: u64,
    /// The true contact at that time. Without force its place means nothing.
    pub contact: Contact,
}

/// A list of gestures in time.
///
/// Each gesture is one contact that means something in the profile it is played for. Its forces and places
/// keep so far from the profile's thresholds that noise, filter and decoder cannot change what it means. What
/// it means is written down with it, not computed from the contact.
#[derive(Clone, Debug, PartialEq)]
pub struct Script {
    keyframes: Vec<Keyframe>,
    contacts: usize,
    expected: Vec<(OutputDevice, Code, i32)>,
    /// After so long it begins anew.
    round_us: Option<u64>,
}

impl Script {
    /// Plays as many gestures as fit into `duration_us`, over and over. A gesture that the profile has no
    /// binding for, or that its numbers make impossible or doubtful, is left out; if none is left the pad
    /// rests.
    ///
    /// The timing is right for a pad at 1 kHz or faster; the profile's filter is slower on a slower pad.
    pub fn for_profile(profile: &Profile, duration_us: u64) -> Self {
        let mut script = Self { keyframes: Vec::new(), contacts: 0, expected: Vec::new(), round_us: None };
        let duration_us = duration_us.min(DURATION_MAX_US);
        let mut now_us = REST_AT_START_US;
        for gesture in gestures(profile).iter().cycle() {
            let end_us = now_us.saturating_add(gesture.duration_us());
            let lifted_us = now_us.saturating_add(gesture.contact_us());
            if end_us.max(lifted_us.saturating_add(REST_AT_END_US)) > duration_us {
                break;
            }
            script.append(gesture, now_us);
            gesture.expect(&mut script.expected);
            now_us = end_us;
        }
        script
    }

    /// Plays all gestures one after the other, and again from the beginning, without an end. Contacts and events are those of one round.
    pub fn endless(profile: &Profile) -> Self {
        let all = gestures(profile);
        let length_us: u64 = all.iter().map(|gesture| gesture.duration_us().max(gesture.contact_us())).sum();
        let round_us = (REST_AT_START_US + length_us + REST_AT_END_US).min(DURATION_MAX_US);
        Self { round_us: Some(round_us), ..Self::for_profile(profile, round_us) }
    }

    /// Plays contacts that somebody else has thought out, in order of time. What they mean is not known here: no
    /// contacts are counted and no events expected.
    pub const fn of(keyframes: Vec<Keyframe>) -> Self {
        Self { keyframes, contacts: 0, expected: Vec::new(), round_us: None }
    }

    /// The true contact at `t_us` from the start; no force between gestures, before the first and after the
    /// last.
    pub fn contact_at(&self, t_us: u64) -> Contact {
        let t_us = self.round_us.map_or(t_us, |round_us| t_us % round_us);
        let next = self.keyframes.partition_point(|keyframe| keyframe.at_us <= t_us);
        let Some(from) = next.checked_sub(1).and_then(|last| self.keyframes.get(last)) else {
            return Contact::default();
        };
        match self.keyframes.get(next) {
            Some(to) => between(from, to, t_us),
            None => from.contact,
        }
    }

    /// How many contacts the script makes.
    pub fn contacts(&self) -> usize {
        self.contacts
    }

    /// The events that a correct bridge emits, in order: device, control and new value. At the end nothing is
    /// held. How far the pointer moves is not among them: that depends on each sample's noise.
    pub fn expected(&self) -> &[(OutputDevice, Code, i32)] {
        &self.expected
    }

    /// The moments between which the contact moves, in order of time.
    pub fn keyframes(&self) -> &[Keyframe] {
        &self.keyframes
    }

    fn append(&mut self, gesture: &Gesture, start_us: u64) {
        let Some(first) = gesture.steps.first() else { return };
        let mut at_us = start_us;
        let contact = Contact { x_mm: first.contact.x_mm, y_mm: first.contact.y_mm, ..Contact::default() };
        self.keyframes.push(Keyframe { at_us, contact });
        for step in &gesture.steps {
            for pause_us in [step.ramp_us, step.stay_us] {
                at_us = at_us.saturating_add(pause_us);
                self.keyframes.push(Keyframe { at_us, contact: step.contact });
            }
        }
        self.contacts += 1;
    }
}

/// The contact between two keyframes; speed is zero at both.
fn between(from: &Keyframe, to: &Keyframe, t_us: u64) -> Contact {
    let length_us = to.at_us.saturating_sub(from.at_us).max(1);
    let part = t_us.saturating_sub(from.at_us) as f32 / length_us as f32;
    let eased = part * part * (3.0 - 2.0 * part);
    let mix = |a: f32, b: f32| a + (b - a) * eased;
    let (a, b) = (&from.contact, &to.contact);
    Contact {
        x_mm: mix(a.x_mm, b.x_mm),
        y_mm: mix(a.y_mm, b.y_mm),
        fx_n: mix(a.fx_n, b.fx_n),
        fy_n: mix(a.fy_n, b.fy_n),
        fz_n: mix(a.fz_n, b.fz_n),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::contact::statics::Statics;
    use crate::pipeline::mapping::profile::{Action, Binding, Dpad, DpadMode, Force, Keys};
    use crate::quantity::{CHANNELS, Strain};
    use crate::virtual_pad::firmware::VirtualPad;
    use crate::virtual_pad::fixture::{EAST, HAT_X, HAT_Y, SOUTH, messages, shipped_profiles};
    use firmware_proto::frame::Message;

    const TEN_SECONDS_US: u64 = 10_000_000;

    #[test]
    fn an_endless_script_plays_every_gesture_in_each_round() {
        for profile in shipped_profiles() {
            let script = Script::endless(&profile);
            assert_eq!(script.contacts(), gestures(&profile).len(), "{}", profile.name);
            let round_us = script.round_us.unwrap();
            let once = |begin_us: u64| -> Vec<_> {
                (0..round_us).step_by(10_000).map(|t_us| script.contact_at(begin_us + t_us)).collect()
            };
            assert_eq!(once(0), once(7 * round_us), "{}", profile.name);
            assert!(once(0).iter().any(|contact| contact.fz_n > 1.0), "{}", profile.name);
        }
    }

    fn edges(script: &Script) -> Vec<(Code, i32)> {
        script.expected().iter().map(|(_, code, value)| (*code, *value)).collect()
    }

    fn script_with(change: impl Fn(&mut Profile)) -> Script {
        let mut profile = shipped_profiles()[0].clone();
        change(&mut profile);
        Script::for_profile(&profile, TEN_SECONDS_US)
    }

    fn assert_balanced(script: &Script) {
        let mut held: Vec<Code> = Vec::new();
        for (code, value) in edges(script) {
            if value == 0 {
                let place = held.iter().position(|c| *c == code).expect("released what was not held");
                held.remove(place);
            } else {
                assert!(!held.contains(&code), "{code:?} pressed twice");
                held.push(code);
            }
        }
        assert_eq!(held, [], "held at the end");
    }

    #[test]
    fn ten_seconds_show_everything_a_shipped_profile_can_do() {
        for profile in shipped_profiles() {
            let script = Script::for_profile(&profile, TEN_SECONDS_US);
            println!("{}: {} contacts, {} events", profile.name, script.contacts(), script.expected().len());
            assert!(script.contacts() >= 10, "{}: {}", profile.name, script.contacts());
            let edges = edges(&script);
            for wanted in [(HAT_X, 1), (HAT_X, -1), (HAT_Y, 1), (HAT_Y, -1), (SOUTH, 1), (EAST, 1)] {
                assert!(edges.contains(&wanted), "{}: {wanted:?}", profile.name);
            }
            assert!(script.expected().iter().all(|(device, ..)| *device == OutputDevice::Gamepad));
            assert_balanced(&script);
        }
    }

    #[test]
    fn a_press_means_what_a_reader_of_the_profile_expects() {
        let [mario, tetris, _, contra] = shipped_profiles();
        let cross = [
            (HAT_X, 1),
            (HAT_X, 0),
            (HAT_Y, -1),
            (HAT_Y, 0),
            (HAT_X, -1),
            (HAT_X, 0),
            (HAT_Y, 1),
            (HAT_Y, 0),
        ];
        let tap_and_hold = [(SOUTH, 1), (SOUTH, 0), (EAST, 1), (EAST, 0)];
        let turn = [(HAT_X, 1), (HAT_X, 0), (HAT_Y, -1), (HAT_Y, 0)];
        let tap_on_the_right = [(HAT_X, 1), (SOUTH, 1), (SOUTH, 0), (HAT_X, 0)];
        for profile in [mario, tetris] {
            let played = edges(&Script::for_profile(&profile, TEN_SECONDS_US));
            let wanted = [&cross[..], &tap_and_hold, &turn, &tap_on_the_right].concat();
            assert_eq!(played[..wanted.len()], wanted);
        }
        let jump_and_fire = tap_and_hold;
        let over_the_diagonal = [(HAT_X, 1), (HAT_Y, -1), (HAT_X, 0), (HAT_Y, 0)];
        let run_and_fire = [(HAT_X, 1), (EAST, 1), (EAST, 0), (HAT_X, 0)];
        let wanted =
            [&cross[..], &jump_and_fire, &over_the_diagonal, &tap_on_the_right, &run_and_fire].concat();
        assert_eq!(edges(&Script::for_profile(&contra, TEN_SECONDS_US))[..wanted.len()], wanted);
    }

    #[test]
    fn the_pad_rests_at_the_start_and_at_the_end() {
        for profile in shipped_profiles() {
            for duration_us in [2_000_000, TEN_SECONDS_US, 20_000_000] {
                let script = Script::for_profile(&profile, duration_us);
                let fz_n = |t_us| script.contact_at(t_us).fz_n;
                assert!((0..=REST_AT_START_US).step_by(1000).all(|t_us| fz_n(t_us) == 0.0));
                assert!(fz_n(REST_AT_START_US + 1000) > 0.0);
                let end = duration_us - REST_AT_END_US;
                assert!((end..end + 1_000_000).step_by(1000).all(|t_us| fz_n(t_us) == 0.0));
                assert_eq!(fz_n(u64::MAX), 0.0);
            }
        }
    }

    #[test]
    fn longer_scripts_go_on_where_shorter_ones_end() {
        let scripts = [0, 599_999, 1_200_000, TEN_SECONDS_US, 30_000_000]
            .map(|duration_us| Script::for_profile(&shipped_profiles()[0], duration_us));
        assert_eq!(scripts.each_ref().map(|script| script.contacts() > 0), [false, false, true, true, true]);
        for pair in scripts.windows(2) {
            assert_eq!(pair[1].expected()[..pair[0].expected().len()], *pair[0].expected());
        }
        assert!(scripts[4].contacts() > 2 * scripts[3].contacts());
        assert_balanced(&scripts[4]);
        assert_eq!(scripts[0].contact_at(5), Contact::default());
    }

    #[test]
    fn a_script_ends_after_a_day() {
        let script = Script::for_profile(&shipped_profiles()[0], u64::MAX);
        let last = script.keyframes().last().unwrap().at_us;
        assert!(last <= DURATION_MAX_US && last > DURATION_MAX_US - 3_000_000);
    }

    #[test]
    fn contacts_move_without_jumps() {
        for profile in shipped_profiles() {
            let script = Script::for_profile(&profile, TEN_SECONDS_US);
            let mut before = script.contact_at(0);
            for t_us in (0..TEN_SECONDS_US).step_by(1000) {
                let now = script.contact_at(t_us);
                assert!((now.fz_n - before.fz_n).abs() < 0.12 && (now.fy_n - before.fy_n).abs() < 0.12);
                let moved_mm = libm::hypotf(now.x_mm - before.x_mm, now.y_mm - before.y_mm);
                assert!(moved_mm < 0.5 || (now.fz_n == 0.0 && before.fz_n < 0.01), "{before:?} {now:?}");
                before = now;
            }
        }
    }

    #[test]
    fn what_a_profile_does_not_have_is_left_out() {
        let only_directions = script_with(|profile| profile.buttons.clear());
        assert!(only_directions.contacts() > 10);
        assert!(edges(&only_directions).iter().all(|(code, _)| matches!(code, Code::Axis(_))));
        let only_buttons = script_with(|profile| profile.dpad = None);
        assert!(only_buttons.contacts() > 10);
        assert_eq!(edges(&only_buttons)[..4], [(SOUTH, 1), (SOUTH, 0), (EAST, 1), (EAST, 0)]);
        let nothing = script_with(|profile| {
            profile.dpad = None;
            profile.buttons.clear();
        });
        assert_eq!((nothing.contacts(), nothing.expected().len()), (0, 0));
    }

    fn dpad(profile: &mut Profile) -> &mut Dpad {
        profile.dpad.as_mut().unwrap()
    }

    #[test]
    fn what_the_numbers_make_impossible_is_left_out() {
        let has = |script: &Script, wanted: Code| edges(script).iter().any(|(code, _)| *code == wanted);
        let far = script_with(|profile| dpad(profile).centre_radius_mm = 24.0);
        assert!(!has(&far, HAT_X) && has(&far, SOUTH), "no room outside the centre");
        let no_centre = script_with(|profile| dpad(profile).centre_radius_mm = 1.0);
        assert_eq!(edges(&no_centre)[8], (HAT_X, 1), "nothing is pressed in a centre of 1 mm");
        let strong = script_with(|profile| profile.buttons[0].press_n = 4.9);
        assert!(has(&strong, HAT_X) && !has(&strong, SOUTH), "beyond the pad's full scale");
        let weak = script_with(|profile| profile.buttons[0].press_n = 0.4);
        assert_eq!(edges(&weak).iter().filter(|(code, _)| *code == HAT_X).count(), 0, "every touch presses");
        let hasty = script_with(|profile| {
            let Action::ByTime { hold: Some(hold), .. } = &mut profile.buttons[0].action else { panic!() };
            hold.us = 120_000;
        });
        assert!(!has(&hasty, SOUTH) && has(&hasty, EAST), "no press is short enough");
        let slow = script_with(|profile| profile.filter_samples = usize::MAX);
        assert_eq!(slow.contacts(), 0);
        let odd = script_with(|profile| profile.buttons[0].press_n = f32::NAN);
        assert!(!has(&odd, SOUTH));
        let touchy = script_with(|profile| profile.buttons[0].force = Force::FyPositive);
        assert!(has(&touchy, SOUTH) && has(&touchy, HAT_X));
    }

    #[test]
    fn rolls_need_room_between_the_sectors() {
        let rolls = |change: &dyn Fn(&mut Dpad)| {
            let script = script_with(|profile| change(dpad(profile)));
            edges(&script).windows(2).filter(|pair| pair[0] == (HAT_X, 0) && pair[1].0 == HAT_Y).count()
        };
        let crosses = rolls(&|dpad| dpad.hysteresis_deg = 41.0);
        assert!(rolls(&|_| {}) > crosses, "a roll changes direction within one contact");
        assert_eq!(rolls(&|dpad| dpad.hysteresis_deg = 1.0), crosses);
    }

    #[test]
    fn controls_that_share_a_key_stay_balanced() {
        let script = script_with(|profile| {
            let shared = Keys::new([Binding { device: OutputDevice::Gamepad, code: SOUTH, value: 1 }]);
            dpad(profile).right = shared;
            dpad(profile).up = shared;
            dpad(profile).mode = DpadMode::EightWay;
        });
        assert_balanced(&script);
        assert!(script.contacts() > 4);
    }

    #[test]
    fn rotation_turns_the_places_and_not_the_meaning() {
        let straight = script_with(|_| {});
        let turned = script_with(|profile| dpad(profile).rotation_deg = 90.0);
        assert_eq!(straight.expected(), turned.expected());
        let (before, after) = (straight.contact_at(700_000), turned.contact_at(700_000));
        assert!(before.x_mm > 10.0 && (after.y_mm - before.x_mm).abs() < 1e-3, "{before:?} {after:?}");
    }

    /// The contact as a host sees it at each millisecond: bytes, scale, zero, mean of six, statics.
    fn decoded(script: &Script, seed: u64) -> Vec<Contact> {
        let mut bytes = Vec::new();
        let mut pad = VirtualPad::new(script.clone(), seed);
        while pad.due_us() < TEN_SECONDS_US {
            pad.emit(pad.due_us() + 100_000, &mut bytes);
        }
        let strain = |message: &Message| {
            let Message::Sample(sample) = message else { panic!("{message:?}") };
            sample.counts.map(|count| count as f32 * 2384e-6)
        };
        let samples: Vec<[f32; CHANNELS]> = messages(&bytes).iter().map(strain).collect();
        let mean = |part: &[[f32; CHANNELS]]| -> [f32; CHANNELS] {
            std::array::from_fn(|k| part.iter().map(|sample| sample[k]).sum::<f32>() / part.len() as f32)
        };
        let zero = mean(&samples[..500]);
        let statics = Statics::nominal();
        let filtered = samples.windows(6).map(mean);
        let strains = filtered.map(|uv| Strain { uv: std::array::from_fn(|k| uv[k] - zero[k]) });
        let contacts = strains.map(|strain| statics.decode(&strain));
        std::iter::repeat_n(Contact::default(), 5).chain(contacts).collect()
    }

    #[test]
    fn every_gesture_reaches_its_targets_through_the_decoder() {
        for (profile, seed) in shipped_profiles().iter().zip(1..) {
            let script = Script::for_profile(profile, TEN_SECONDS_US);
            let decoded = decoded(&script, seed);
            let mut reached = 0;
            for pair in script.keyframes().windows(2) {
                let (from, to) = (pair[0], pair[1]);
                if from.contact != to.contact || from.contact.fz_n == 0.0 || to.at_us == from.at_us {
                    continue;
                }
                let target = from.contact;
                for seen in &decoded[(from.at_us / 1000 + 7) as usize..(to.at_us / 1000) as usize] {
                    let off_mm = libm::hypotf(seen.x_mm - target.x_mm, seen.y_mm - target.y_mm);
                    let off_n = libm::hypotf(seen.fx_n - target.fx_n, seen.fy_n - target.fy_n);
                    assert!(off_mm < 0.6, "{}: {target:?} {seen:?}", profile.name);
                    assert!(off_n < 0.02 + 0.07 * target.fz_n, "{}: {target:?} {seen:?}", profile.name);
                    assert!((seen.fz_n - target.fz_n).abs() < 0.02, "{}: {target:?} {seen:?}", profile.name);
                }
                reached += 1;
            }
            assert!(reached > script.contacts(), "{reached}");
        }
    }
}
