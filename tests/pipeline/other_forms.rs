//! Pads that send something else than nine channels: contacts that they decoded, or fewer channels.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use firmware_proto::ENCODED_MAX;
use firmware_proto::channels::ChannelSample;
use firmware_proto::contact::ContactSample;
use firmware_proto::frame::Message;
use firmware_proto::identity::{Identity, SerialNumber};
use firmware_proto::link::encode_message;
use firmware_proto::sample::Status;
use tactpad::pad::weight::Weight;
use tactpad::pipeline::contact::read::playing;
use tactpad::pipeline::refusal::Refusal;
use tactpad::pipeline::weighing::Progress;
use tactpad::pipeline::weighing::refusal::WeighError;
use tactpad::pipeline::{NoProbe, Phase, Pipeline};
use tactpad::source::shipped;

use crate::rig::{Rig, profile};

fn frame(message: &Message) -> Vec<u8> {
    let mut frame = [0; ENCODED_MAX];
    let length = encode_message(message, &mut frame);
    frame[..length].to_vec()
}

impl Rig {
    /// A pad that decodes on its own tells this contact for so long, in micrometres and millinewtons; nothing without one.
    fn tell(&mut self, contact: Option<([i32; 2], i32)>, ms: u64) {
        for _ in 0..ms {
            self.now_us += 1_000;
            self.sequence = self.sequence.wrapping_add(1);
            let untouched = ContactSample::untouched(self.sequence, self.now_us);
            let sample = contact.map_or(untouched, |(place_um, fz_mn)| ContactSample {
                place_um,
                force_mn: [0, 0, fz_mn],
                place_deviation_um: 400,
                is_touched: true,
                ..untouched
            });
            self.bytes(&frame(&Message::Contact(sample)));
        }
    }

    /// A pad with few channels reads these counts for so long, with some noise.
    fn read(&mut self, counts: [i32; 4], ms: u64) {
        for _ in 0..ms {
            self.now_us += 1_000;
            self.sequence = self.sequence.wrapping_add(1);
            let jitter = (self.sequence % 3) as i32;
            let sample = ChannelSample::new(
                self.sequence,
                self.now_us,
                &counts.map(|count| count + jitter),
                Status::OK,
            );
            self.bytes(&frame(&Message::Channels(sample.unwrap())));
        }
    }
}

const RIGHT: ([i32; 2], i32) = ([15_000, 0], 1_000);
const PRESS: ([i32; 2], i32) = ([0, 0], 3_000);

/// A rig on the shipped load cells.
fn cells() -> Rig {
    let mut rig = Rig::new(profile("super-mario"));
    let decoder = playing(shipped::text("load-cells").unwrap().as_bytes()).unwrap();
    rig.pipeline = Pipeline::new(decoder, profile("super-mario"));
    rig
}

#[test]
fn a_pad_that_decodes_on_its_own_plays_at_once_with_any_decoder() {
    for mut rig in [Rig::new(profile("super-mario")), cells()] {
        rig.tell(Some(RIGHT), 100);
        assert_eq!((rig.pipeline.phase(), rig.take_events()), (Phase::Playing, vec!["ABS_HAT0X=1".into()]));
        let deviation_mm = rig.pipeline.estimate().unwrap().covariance[0][0].sqrt();
        assert!((deviation_mm - 0.4).abs() < 1e-6, "{deviation_mm}");
        rig.tell(None, 100);
        rig.tell(Some(PRESS), 395);
        rig.tell(None, 100);
        rig.tell(Some(PRESS), 500);
        rig.tell(None, 100);
        let events = ["ABS_HAT0X=0", "BTN_SOUTH=1", "BTN_SOUTH=0", "BTN_EAST=1", "BTN_EAST=0"];
        assert_eq!(rig.take_events(), events);
        assert!(rig.pipeline.strain().is_none() && rig.pipeline.refusal().is_none());
    }
}

#[test]
fn contacts_that_are_lost_or_at_fault_are_let_go_of() {
    let mut rig = Rig::new(profile("super-mario"));
    rig.tell(Some(RIGHT), 100);
    rig.sequence += 30;
    rig.now_us += 30_000;
    rig.tell(Some(RIGHT), 10);
    assert_eq!(rig.take_events(), ["ABS_HAT0X=1", "ABS_HAT0X=0"], "frames are lost");
    rig.tell(Some(RIGHT), 100);
    assert_eq!(rig.take_events(), ["ABS_HAT0X=1"]);
    let fault = ContactSample {
        status: Status::OK.with_supply_fault(),
        is_touched: true,
        ..ContactSample::untouched(rig.sequence + 1, rig.now_us + 1_000)
    };
    rig.bytes(&frame(&Message::Contact(fault)));
    assert_eq!((rig.take_events(), rig.pipeline.phase()), (vec!["ABS_HAT0X=0".into()], Phase::Faulty));
    let mut silent = Rig::new(profile("super-mario"));
    silent.tell(Some(RIGHT), 100);
    silent.silence(90);
    assert_eq!(silent.take_events(), ["ABS_HAT0X=1", "ABS_HAT0X=0"], "the pad is silent");
}

#[test]
fn few_channels_play_by_their_description_and_are_refused_without() {
    let mut rig = cells();
    // 20 N at 50 mm to the right, in hundredths of a gram.
    let [left, right] = [0.125, 0.375].map(|share| (share * 20.0 / 9.806_65e-3 * 100.0) as i32);
    let offset = [120_000, -4_000, 0, 77];
    rig.read(offset, 500);
    rig.read([offset[0] + left, offset[1] + right, offset[2] + left, offset[3] + right], 200);
    rig.read(offset, 200);
    assert_eq!(rig.take_events()[..1], ["ABS_HAT0X=1"]);
    assert!(rig.is_neutral());

    let mut stranger = Rig::new(profile("super-mario"));
    stranger.read(offset, 300);
    let refusal = stranger.pipeline.refusal().copied().unwrap();
    assert_eq!(
        (refusal, stranger.pipeline.phase()),
        (Refusal::OtherChannels { channels: 4, wanted: 9 }, Phase::Refused)
    );
    assert!(refusal.to_string().contains("sends 4 channels, and its decoder takes nine"), "{refusal}");
    // The pad that is meant comes back.
    stranger.silence(500);
    stranger.sequence = 0;
    stranger.rest(600);
    stranger.press(15.0, 0.0, 1.0, 200);
    assert_eq!(stranger.pipeline.refusal(), None);
    assert_eq!(stranger.take_events(), ["ABS_HAT0X=1"]);

    let mut other = cells();
    other.rest(100);
    assert_eq!(other.pipeline.refusal(), Some(&Refusal::OtherChannels { channels: 9, wanted: 4 }));
}

/// A board of 2.4 kg that somebody takes up and puts down: its cells hang free as still as they stand.
#[test]
fn a_board_that_was_taken_up_holds_nothing_and_plays_again() {
    let own = [60_000; 4];
    for up_ms in [30, 150, 400, 1_000, 6_000] {
        let mut rig = cells();
        rig.read(own, 600);
        rig.read([0; 4], up_ms);
        rig.read(own, 4_000);
        assert!(
            rig.is_neutral() && rig.pipeline.phase() == Phase::Playing,
            "{up_ms} ms: {:?}",
            rig.pipeline.phase()
        );
        rig.take_events();
        let [left, right] = [0.125, 0.375].map(|share| (share * 20.0 / 9.806_65e-3 * 100.0) as i32);
        rig.read([own[0] + left, own[1] + right, own[2] + left, own[3] + right], 200);
        assert_eq!(rig.take_events(), ["ABS_HAT0X=1"], "{up_ms} ms");
        rig.read(own, 200);
        assert!(rig.is_neutral(), "{up_ms} ms");
        // A press that is held is no board that was put down.
        rig.read([own[0] + left, own[1] + right, own[2] + left, own[3] + right], 6_000);
        assert_eq!(rig.take_events().last().map(String::as_str), Some("ABS_HAT0X=1"), "{up_ms} ms");
    }
}

/// What is pulled at for a moment is no load afterwards, and plays within a second or so.
#[test]
fn a_pull_leaves_nothing_behind() {
    for (pull, ms) in [(-3_000, 150), (-3_000, 1_000), (-20_000, 300)] {
        let mut rig = cells();
        rig.read([0; 4], 600);
        rig.read([pull; 4], ms);
        rig.read([0; 4], 4_500);
        assert!(rig.is_neutral() && rig.pipeline.phase() == Phase::Playing, "{pull} for {ms} ms");
    }
}

#[test]
fn who_they_say_they_are_is_held_against_their_description() {
    let identity = |channels| {
        let serial_number = SerialNumber::from_ascii("B-1").unwrap();
        Message::Identity(Identity {
            serial_number,
            channels,
            count_bits: 24,
            rate_hz: 100,
            picovolts_per_count: 1,
        })
    };
    for (mut rig, channels, is_fit) in
        [(cells(), 4, true), (cells(), 9, false), (cells(), 0, true), (Rig::new(profile("tetris")), 4, false)]
    {
        rig.bytes(&frame(&identity(channels)));
        assert_eq!(rig.pipeline.refusal().is_none(), is_fit, "{channels}");
    }
}

#[test]
fn a_weight_tells_nothing_of_them_and_that_is_said() {
    let weigh = |rig: &mut Rig| {
        rig.pipeline.weigh(rig.host(), Weight::of_g(200.0).unwrap());
        rig.pipeline.weighing().map(|report| report.progress)
    };
    let mut board = cells();
    board.read([0; 4], 500);
    assert!(matches!(weigh(&mut board), Some(Progress::Ended(Err(WeighError::NoNineChannels)))));
    let mut own = Rig::new(profile("super-mario"));
    own.tell(None, 100);
    assert!(matches!(weigh(&mut own), Some(Progress::Ended(Err(WeighError::NoNineChannels)))));
}

#[test]
fn neither_allocates() {
    let mut frames = Vec::new();
    for number in 0..4_000_u32 {
        let time_us = 1_000 * u64::from(number);
        let is_down = number > 1_000 && number % 400 < 200;
        let load = if is_down { 76_000 } else { 0 };
        let counts = [1, 2, 3, 4].map(|k: i32| load * k / 4 + (number % 5) as i32);
        let contact = ContactSample {
            place_um: [15_000, 0],
            force_mn: [0, 0, 3_000],
            is_touched: is_down,
            ..ContactSample::untouched(number, time_us)
        };
        let sample = ChannelSample::new(number, time_us, &counts, Status::OK).unwrap();
        frames.push([frame(&Message::Contact(contact)), frame(&Message::Channels(sample))]);
    }
    for kind in 0..2 {
        let mut rig = cells();
        let mut events = 0;
        let allocated = allocation_counter::measure(|| {
            for pair in &frames {
                rig.now_us += 1_000;
                let mut rest = &pair[kind][..];
                while !rest.is_empty() {
                    let taken = rig.pipeline.handle_bytes(rig.host(), rest, &mut NoProbe);
                    events += rig.pipeline.events().len();
                    rest = &rest[taken..];
                }
                rig.pipeline.handle_timeout(rig.host());
            }
        });
        assert!(events > 5, "{events}");
        assert_eq!(allocated.count_total, 0);
    }
}
