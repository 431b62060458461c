//! Stories that once broke an invariant, in their shortest forms. Each stays a test.

use super::event::Event::{
    Ask, ClockJump, Damage, DamagePermille, Freeze, Keep, Lift, LossPermille, Mend, Off, OffToo, Pace,
    PlugIn, PullOut, Rate, Repeat, Restart, Sleep, Stall, Touch,
};
use super::event::Off::{Drift, Rail, Saturated, Stuck};
use super::event::{Event, PortState, RIGHT, Step, Wish};
use super::play;
use tactpad_core::quantity::Contact;

const PLUG_IN: Event = PlugIn { is_anew: true };

const RESTART: Event = Restart { time_us: 0, is_flagged: true, offset: 295_156, text: 3 };

const HANDLED_BEFORE: Event = Restart { time_us: 0, is_flagged: false, offset: -170_497, text: 0 };

/// A finger that is there while the zero is measured.
const FINGER: Contact = Contact { x_mm: -21.9, y_mm: -11.2, fx_n: 0.0, fy_n: 0.0, fz_n: 1.2 };

/// A story is played with each of these.
const SEEDS: std::ops::RangeInclusive<u64> = 1..=16;

fn holds(steps: &[(u32, Event)]) {
    let steps: Vec<Step> =
        steps.iter().map(|(after_ms, event)| Step { after_ms: *after_ms, event: *event }).collect();
    // Which frames are lost, and whether a page watches, is the seed's.
    for seed in SEEDS {
        assert_eq!(play(seed, &steps, true).map(|_| ()), Ok(()), "seed {seed}: {steps:?}");
    }
}

#[test]
fn a_machine_that_stands_still_right_after_the_pad_came() {
    holds(&[(0, PLUG_IN), (1, Freeze(3_000)), (3_239, Mend), (3_000, Mend)]);
}

#[test]
fn a_hub_that_hands_on_damaged_frames_accuses_no_clock() {
    holds(&[
        (0, PLUG_IN),
        (10, Keep(true)),
        (7_130, Keep(false)),
        (111, DamagePermille(300)),
        (0, Mend),
        (3_000, Mend),
    ]);
}

#[test]
fn samples_that_a_hub_kept_from_the_first_on_accuse_no_clock() {
    holds(&[(0, Rate(100)), (1, PLUG_IN), (0, Keep(true)), (3_000, Lift), (0, Mend)]);
    holds(&[
        (0, Rate(250)),
        (0, Mend),
        (0, PullOut),
        (0, PLUG_IN),
        (0, Keep(true)),
        (0, Freeze(3_000)),
        (0, Mend),
    ]);
}

#[test]
fn a_pad_that_stops_for_a_moment_has_no_bad_clock() {
    let old = |age, frames| Repeat { age, frames };
    holds(&[(0, PLUG_IN), (10, Stall(true)), (100, old(3, 4)), (856, Stall(false)), (100, Lift), (0, Mend)]);
    let slowly = [(0, PLUG_IN), (0, Rate(100)), (100, Stall(true)), (0, Damage(1))];
    let again = [(1_000, old(3, 4)), (10, Lift), (856, Stall(false)), (100, Lift), (0, Mend)];
    holds(&[&slowly[..], &again].concat());
    holds(&[(0, Mend), (0, Stall(true)), (100, old(66, 2)), (1_000, Stall(true)), (0, Mend)]);
}

#[test]
fn an_old_frame_does_not_accuse_the_pads_clock() {
    let repeat = Repeat { age: 66, frames: 4 };
    holds(&[
        (0, Mend),
        (1_428, ClockJump(14_339_583)),
        (1, Stall(true)),
        (384, repeat),
        (10, Mend),
        (3_000, Mend),
    ]);
}

#[test]
fn a_clock_that_is_sound_again_is_believed_after_a_second() {
    holds(&[(0, Mend), (0, Pace(20_000)), (218, Touch(RIGHT)), (0, Mend)]);
}

#[test]
fn a_clock_that_is_far_too_fast_is_named_also_after_a_silence() {
    holds(&[(0, Rate(100)), (1, Mend), (0, Pace(20_000)), (0, Damage(70)), (12_229, Mend)]);
}

#[test]
fn frames_that_are_lost_were_sent() {
    holds(&[(0, Mend), (0, Rate(100)), (0, LossPermille(300)), (5_947, Lift), (0, Mend)]);
}

#[test]
fn a_silence_after_a_bad_line_is_named() {
    let silent = [(0, PLUG_IN), (0, DamagePermille(25)), (3_000, Keep(true)), (24_731, PullOut), (0, Mend)];
    holds(&silent);
    holds(&[(0, PLUG_IN), (0, Off(7, Stuck)), (3_000, Stall(true)), (15_687, Mend)]);
}

#[test]
fn a_silence_after_a_bad_clock_is_named() {
    holds(&[(0, Pace(3_000)), (0, PLUG_IN), (2_505, Keep(true)), (0, Pace(1_010)), (12_000, Mend)]);
}

#[test]
fn a_pad_that_begins_anew_in_its_first_samples_has_its_zero_measured_anew() {
    let anew = |time_us| Restart { time_us, is_flagged: true, offset: -150_355, text: 3 };
    holds(&[(0, Rate(250)), (0, PLUG_IN), (7, anew(4_292_825_030)), (0, anew(0)), (1_000, Mend)]);
}

#[test]
fn channels_that_stand_one_after_the_other_are_named() {
    holds(&[(0, Mend), (0, Off(3, Stuck)), (13_000, Off(7, Stuck)), (7_000, Mend)]);
}

#[test]
fn states_that_take_turns_do_not_go_without_a_word() {
    let weigh = |g| Ask(Wish::Weigh { g });
    holds(&[
        (0, Mend),
        (0, weigh(200)),
        (830, weigh(50)),
        (950, Event::Identify(2)),
        (880, Ask(Wish::Pause)),
        (549, Mend),
    ]);
}

#[test]
fn a_channel_that_drifts_while_the_zero_is_measured_is_no_load() {
    let anew = Restart { time_us: 14_678_922, is_flagged: true, offset: -330_366, text: 1 };
    holds(&[(0, Rate(125)), (0, Mend), (0, anew), (0, Off(8, Drift { uv_per_s: 174 })), (2_118, Mend)]);
    let two = [(0, Off(3, Drift { uv_per_s: 285 })), (0, OffToo(5, Stuck)), (0, PLUG_IN), (0, RESTART)];
    holds(&[&two[..], &[(859, OffToo(5, Saturated)), (325, Mend)]].concat());
}

#[test]
fn a_channel_that_was_stuck_as_the_pad_began_answers_under_a_finger() {
    let sleep = Sleep { s: 1, is_powered: false };
    let begun =
        [(0, Rate(100)), (0, PLUG_IN), (0, Off(2, Stuck)), (0, RESTART), (0, Touch(RIGHT)), (0, sleep)];
    holds(&[&begun[..], &[(1_000, Stall(true)), (10, Mend)]].concat());
}

#[test]
fn a_number_that_is_near_by_chance_is_no_sign_that_a_pad_did_not_begin_anew() {
    let finger = Contact { x_mm: 15.3, y_mm: -1.0, fx_n: 1.3, fy_n: 0.4, fz_n: 1.5 };
    let first = Restart { time_us: 0, is_flagged: true, offset: -260_853, text: 1 };
    let second = Restart { time_us: 26_664_772, is_flagged: false, offset: 167_507, text: 3 };
    holds(&[
        (0, Rate(100)),
        (0, Mend),
        (0, Freeze(3_000)),
        (0, first),
        (1_000, Touch(finger)),
        (805, second),
        (0, Mend),
    ]);
}

#[test]
fn stream_time_does_not_run_away_from_samples_that_wait() {
    holds(&[(0, PLUG_IN), (3, Repeat { age: 2, frames: 3 }), (0, Freeze(687)), (687, Mend)]);
}

#[test]
fn one_frame_of_the_run_before_is_not_the_lowest_load() {
    let again = Restart { time_us: 0, is_flagged: false, offset: 0, text: 0 };
    let begun = [(0, PLUG_IN), (0, HANDLED_BEFORE), (1, Freeze(59)), (59, again), (0, Off(0, Saturated))];
    holds(&[&begun[..], &[(3, Event::Cure), (0, Repeat { age: 1, frames: 2 }), (21, Mend)]].concat());
}

#[test]
fn a_zero_under_a_finger_with_a_channel_that_was_off_is_found_out() {
    let rail = |channel, mv, noise_uv| Off(channel, Rail { mv, noise_uv });
    holds(&[
        (0, PLUG_IN),
        (0, rail(8, -2, 1)),
        (0, Touch(FINGER)),
        (181, Lift),
        (0, rail(0, -11, 823)),
        (2_762, Mend),
    ]);
}

#[test]
fn a_number_that_begins_again_is_believed_to_until_it_has_counted_past_it() {
    let first = Restart { time_us: 18_446_744_073_707_708_753, is_flagged: true, offset: -170_785, text: 3 };
    let second =
        Restart { time_us: 18_446_744_073_709_348_847, is_flagged: false, offset: -233_440, text: 2 };
    holds(&[(0, Mend), (0, first), (1_275, second), (0, Rate(100)), (0, Mend)]);
}

#[test]
fn a_pad_that_begins_anew_twice_is_not_accused_of_a_number_that_begins_again() {
    let first = Restart { time_us: 8_943_279_490_491_222_804, is_flagged: true, offset: 328_118, text: 1 };
    let second =
        Restart { time_us: 18_446_744_073_708_191_687, is_flagged: false, offset: -314_067, text: 3 };
    let slept = Sleep { s: 60, is_powered: true };
    holds(&[(0, Mend), (1_435, first), (10, slept), (508, second), (0, Mend)]);
}

#[test]
fn a_channel_that_answers_again_is_told_of_no_more_though_frames_are_lost() {
    holds(&[
        (0, Rate(250)),
        (380, PLUG_IN),
        (76, Off(6, Saturated)),
        (2_551, Event::Cure),
        (388, DamagePermille(25)),
        (614, Rate(200)),
        (1_341, Mend),
    ]);
}

#[test]
fn samples_that_are_lost_while_the_clock_jumps_were_sent() {
    holds(&[
        (0, Rate(100)),
        (0, PLUG_IN),
        (100, Ask(Wish::Weigh { g: 50 })),
        (0, Touch(RIGHT)),
        (0, Mend),
        (0, DamagePermille(300)),
        (2_770, Pace(20_000)),
        (0, Lift),
        (1_000, Mend),
    ]);
}

#[test]
fn a_clock_that_is_three_times_too_fast_is_named() {
    holds(&[(0, Rate(100)), (0, Mend), (0, Ask(Wish::Tare)), (0, Pace(3_000)), (18_679, Mend)]);
}

#[test]
fn a_clock_that_is_too_fast_is_named_though_frames_are_lost() {
    let anew = Restart { time_us: 18_446_744_073_707_900_445, is_flagged: false, offset: -69_372, text: 1 };
    let begun = [(0, Rate(500)), (0, PLUG_IN), (0, anew), (0, Event::Lose(70)), (0, Pace(20_000))];
    holds(&[&begun[..], &[(0, DamagePermille(25)), (28_316, Mend)]].concat());
}

#[test]
fn a_pad_that_begins_anew_while_the_zero_is_measured_is_not_loaded() {
    let anew = Restart { time_us: 4_292_648_044, is_flagged: false, offset: -286_536, text: 2 };
    holds(&[(0, Rate(100)), (0, PLUG_IN), (10, anew), (0, Rate(4_000)), (368, Mend)]);
}

#[test]
fn frames_that_come_late_over_a_silence_are_let_go_of_in_time() {
    holds(&[
        (0, Rate(100)),
        (0, Mend),
        (0, Damage(70)),
        (0, Touch(RIGHT)),
        (676, Repeat { age: 64, frames: 3 }),
    ]);
}

#[test]
fn a_pad_that_had_run_for_a_moment_and_begins_anew_while_the_machine_stands_still_is_found_out() {
    let slept = Sleep { s: 60, is_powered: false };
    let anew = Restart { time_us: 17_179_899_831_365_364_586, is_flagged: true, offset: 190_107, text: 2 };
    let begun = [(0, Mend), (0, slept), (467, Freeze(300)), (75, anew), (0, Freeze(3_000))];
    holds(&[&begun[..], &[(0, ClockJump(0)), (0, Mend)]].concat());
}

#[test]
fn a_clock_that_falls_shows_nothing() {
    let anew = Restart { time_us: 18_446_744_073_708_855_205, is_flagged: true, offset: -2_759, text: 0 };
    let begun = [(0, Event::ClockBits(32)), (0, Mend), (0, Pace(1)), (0, anew), (550, LossPermille(300))];
    holds(&[&begun[..], &[(182, Lift), (53, Mend)]].concat());
}

#[test]
fn a_channel_that_was_off_does_not_hide_that_the_zero_is_a_load() {
    let off = Off(2, Rail { mv: -18, noise_uv: 1_631 });
    let begun =
        [(0, Rate(125)), (0, off), (0, Touch(RIGHT)), (0, PlugIn { is_anew: false }), (0, Keep(true))];
    holds(&[&begun[..], &[(296, Lift), (0, Rate(100)), (0, Mend)]].concat());
}

#[test]
fn a_pad_that_begins_anew_as_soon_as_it_had_begun_is_not_loaded() {
    let anew = Restart { time_us: 0, is_flagged: false, offset: 249_870, text: 1 };
    holds(&[(0, PLUG_IN), (1, anew), (676, Sleep { s: 3_600, is_powered: false })]);
}

#[test]
fn a_channel_that_stood_does_not_hide_that_the_zero_is_a_load() {
    let finger = Contact { x_mm: -15.6, y_mm: -15.0, fx_n: 0.0, fy_n: 0.0, fz_n: 2.7 };
    let begun = [(0, Rate(100)), (0, Off(8, Stuck)), (0, PlugIn { is_anew: false }), (2_288, Touch(RIGHT))];
    holds(&[&begun[..], &[(0, Touch(finger)), (0, Event::Lose(1_000)), (354, Mend)]].concat());
}

#[test]
fn a_clock_that_is_too_fast_is_named_though_the_pad_seems_to_begin_anew_all_the_time() {
    let begun = [(0, Rate(200)), (0, PLUG_IN), (10, Touch(RIGHT)), (22, Pace(20_000)), (100, Lift)];
    holds(&[&begun[..], &[(10, DamagePermille(300)), (27_834, Touch(RIGHT))]].concat());
}

#[test]
fn in_a_silence_nothing_passes() {
    let finger = Contact { x_mm: 19.8, y_mm: -12.7, fx_n: 0.1, fy_n: -0.2, fz_n: 0.3 };
    holds(&[(0, PLUG_IN), (0, Touch(finger)), (1_000, Lift), (1, Stall(true)), (3_420, Mend)]);
}

#[test]
fn a_pad_that_begins_anew_behind_a_hub_that_keeps_no_more_is_found_out() {
    let finger = Contact { x_mm: 7.6, y_mm: 13.3, fx_n: 0.0, fy_n: 0.3, fz_n: 1.8 };
    let first = Restart { time_us: 4_293_862_872, is_flagged: false, offset: -137_913, text: 1 };
    let second = Restart { time_us: 6_274_937, is_flagged: true, offset: 269_235, text: 1 };
    let begun = [(184, PlugIn { is_anew: false }), (1_260, Keep(true)), (1_788, first), (935, second)];
    holds(
        &[&begun[..], &[(12_969, Touch(finger)), (542, Keep(false)), (1_000, Lift), (2_784, Mend)]].concat(),
    );
}

#[test]
fn what_is_wrong_is_told_again_once_another_thing_was_told() {
    let begun =
        [(0, Off(7, Stuck)), (0, PlugIn { is_anew: false }), (25_921, Stall(true)), (1_000, Stall(false))];
    holds(&[&begun[..], &[(38_437, Touch(RIGHT))]].concat());
}

#[test]
fn a_pause_that_lasts_is_told_once() {
    let begun = [(0, Mend), (0, Ask(Wish::Pause)), (22_825, Off(4, Stuck)), (14_026, Lift), (4_900, PullOut)];
    holds(&[&begun[..], &[(2_600, Event::Cure), (20_000, Lift)]].concat());
}

#[test]
fn what_is_told_before_a_silence_was_so_then() {
    let finger = Contact { x_mm: 21.5, y_mm: -10.8, fx_n: 0.0, fy_n: 0.0, fz_n: 4.2 };
    holds(&[(1, PLUG_IN), (0, Touch(finger)), (673, Lift), (37, Stall(true)), (3_000, Mend)]);
}

#[test]
fn a_pad_that_begins_anew_with_a_clock_that_runs_is_found_out() {
    let anew = Restart { time_us: 18_446_744_073_706_908_816, is_flagged: false, offset: 146_692, text: 0 };
    let begun = [(0, Rate(100)), (0, Mend), (0, anew), (0, Pace(20_000)), (0, Event::Lose(1_000))];
    holds(&[&begun[..], &[(248, Lift), (0, Mend)]].concat());
}

#[test]
fn a_pad_that_begins_anew_after_its_first_frame_came_again_is_found_out() {
    let again = Restart { time_us: 0, is_flagged: false, offset: -251_203, text: 3 };
    holds(&[(0, Rate(100)), (0, PLUG_IN), (300, Repeat { age: 500, frames: 4 }), (62, again), (961, Lift)]);
}

#[test]
fn a_clock_that_jumps_is_looked_at_from_there_on() {
    holds(&[(0, PLUG_IN), (0, Pace(1)), (777, Pace(990)), (463, ClockJump(50_328_057)), (0, Mend)]);
}

#[test]
fn what_was_found_of_the_clock_stands_until_it_is_taken_back() {
    let begun = [(0, PLUG_IN), (0, Pace(20_000)), (0, Touch(RIGHT)), (3_000, Lift), (66, Touch(FINGER))];
    holds(&[&begun[..], &[(0, Pace(1_010)), (2_023, PullOut), (1_000, Rate(1_000))]].concat());
}

#[test]
fn a_pad_that_begins_anew_while_its_clock_is_in_doubt_is_not_accused_of_the_jump() {
    let begun = [(0, Rate(125)), (0, PLUG_IN), (0, Keep(true)), (1_937, Lift), (624, Rate(4_000))];
    let anew = Restart { time_us: 4_292_932_878, is_flagged: false, offset: -177_586, text: 0 };
    holds(&[&begun[..], &[(86, Keep(false)), (1_518, anew), (348, Lift), (3_000, Mend)]].concat());
}

#[test]
fn a_channel_that_stood_while_the_zero_of_a_slow_pad_was_measured_is_not_accused_when_it_answers() {
    let anew = Restart { time_us: 0, is_flagged: true, offset: 10_665, text: 0 };
    let begun = [(0, Rate(200)), (0, PLUG_IN), (0, Off(4, Stuck)), (2_542, anew)];
    holds(&[&begun[..], &[(1_000, Event::Cure), (386, Lift), (3_000, Mend)]].concat());
}

#[test]
fn an_old_frame_while_the_zero_is_measured_is_no_load() {
    let anew = |time_us, is_flagged, offset| Restart { time_us, is_flagged, offset, text: 0 };
    let again = Repeat { age: 500, frames: 3 };
    let begun = [(0, PLUG_IN), (1, anew(4_294_022_087, true, 116_215)), (0, anew(0, true, -259_762))];
    holds(&[&begun[..], &[(1, again), (513, anew(4_293_000_957, false, 397_728)), (0, Mend)]].concat());
    let slow = [(0, Rate(100)), (0, PLUG_IN), (20, anew(18_446_744_073_709_345_948, true, 347_611))];
    holds(&[&slow[..], &[(213, again), (481, Touch(RIGHT)), (0, Mend)]].concat());
}

#[test]
fn a_number_of_few_bits_hides_no_clock_that_is_set_anew() {
    let anew = Restart { time_us: 4_294_679_742, is_flagged: false, offset: 385_951, text: 0 };
    let begun = [(0, PLUG_IN), (0, Rate(4_000)), (1_000, Event::SequenceBits(8)), (2_000, Damage(2))];
    holds(&[&begun[..], &[(0, anew), (2_000, Mend)]].concat());
}

#[test]
fn an_old_frame_that_is_taken_for_a_gap_is_one() {
    let weigh = |g| Ask(Wish::Weigh { g });
    let begun =
        [(0, Rate(100)), (0, PLUG_IN), (62, Damage(1)), (1, Mend), (311, Stall(true)), (1_354, Event::Cure)];
    let slow = [
        (58, Pace(1)),
        (63, Mend),
        (26, Event::Lose(2)),
        (478, weigh(50)),
        (59, Damage(70)),
        (319, Ask(Wish::Tare)),
    ];
    let pressed = [(207, Lift), (111, Touch(RIGHT)), (637, weigh(500)), (153, Lift), (39, Ask(Wish::Panic))];
    holds(&[&begun[..], &slow, &pressed, &[(5_922, Repeat { age: 66, frames: 2 }), (0, Mend)]].concat());
}

#[test]
fn bytes_that_run_into_a_frame_hide_it() {
    let anew = Restart { time_us: 14_358_397_181_813_044_508, is_flagged: false, offset: 47_444, text: 3 };
    let begun = [(0, Rate(100)), (0, PLUG_IN), (0, Event::SequenceBits(8)), (0, anew)];
    holds(&[&begun[..], &[(2_541, Event::Rubbish(559)), (100, Lift), (0, Mend)]].concat());
}

#[test]
fn another_message_ends_what_bytes_ran_into() {
    let begun =
        [(0, Mend), (0, Stall(true)), (0, Event::Rubbish(685)), (0, Touch(RIGHT)), (0, Event::Identify(0))];
    holds(&[&begun[..], &[(1_000, Stall(false)), (1, Touch(RIGHT))]].concat());
}

#[test]
fn a_link_that_is_lost_forgets_what_bytes_ran_into() {
    let begun = [(0, Mend), (0, Stall(true)), (0, Event::Rubbish(759)), (0, Touch(RIGHT))];
    holds(&[&begun[..], &[(361, Stall(false)), (1, Ask(Wish::Panic))]].concat());
}

#[test]
fn a_number_that_falls_to_the_largest_is_an_old_frame() {
    let finger = Contact { x_mm: -1.4, y_mm: 14.3, fx_n: -0.0, fy_n: -0.0, fz_n: 5.6 };
    let anew = Restart { time_us: 0, is_flagged: false, offset: 325_719, text: 2 };
    let begun = [(0, Rate(100)), (0, Mend), (0, anew), (9, Ask(Wish::Break)), (169, Event::Identify(2))];
    let looked = [(113, Event::PageStall(false)), (13, Ask(Wish::Status)), (2_572, Lift)];
    let touched = [(352, Event::ReaderStall(true)), (60, Touch(RIGHT)), (854, Lift), (905, ClockJump(0))];
    let again =
        [(2_238, Stall(false)), (365, Touch(finger)), (10, Event::SequenceBits(8)), (62, Touch(RIGHT))];
    holds(&[&begun[..], &looked, &touched, &again].concat());
}

#[test]
fn a_channel_that_drifted_under_a_finger_may_look_like_another_one() {
    let drift = |channel, uv_per_s| OffToo(channel, Drift { uv_per_s });
    let begun =
        [(0, PLUG_IN), (0, Off(3, Drift { uv_per_s: -142 })), (1_000, drift(0, 334)), (231, Event::Cure)];
    let hidden = [(0, Mend), (0, drift(5, 265)), (0, Touch(RIGHT)), (2_714, Event::Cure)];
    holds(&[&begun[..], &hidden, &[(0, Lift), (0, Touch(RIGHT)), (1_000, Lift), (1, Mend)]].concat());
}

#[test]
fn a_pad_that_is_changed_while_nobody_reads_leaves_nothing_in_the_old_port() {
    let finger = Contact { x_mm: 14.8, y_mm: 9.7, fx_n: -0.3, fy_n: -1.5, fz_n: 2.4 };
    let begun = [(0, Rate(100)), (0, PLUG_IN), (1, Freeze(3_000)), (0, Sleep { s: 1, is_powered: false })];
    let away =
        [(86, Touch(finger)), (0, Event::Port(PortState::Unusable)), (808, Keep(true)), (0, Keep(false))];
    let again = [(0, Lift), (13_721, Ask(Wish::Tare)), (363, Ask(Wish::Pause)), (0, Mend)];
    holds(&[&begun[..], &away, &again].concat());
}

#[test]
fn a_clock_that_begins_again_at_zero_leaves_no_sample_late_for_ever() {
    let finger = Contact { x_mm: -12.3, y_mm: 5.5, fx_n: 0.0, fy_n: 0.0, fz_n: 1.3 };
    let begun = [(0, Rate(125)), (0, PlugIn { is_anew: false }), (0, ClockJump(18_446_744_073_709_305_899))];
    let stood = [(10, Freeze(300)), (164, Rate(500)), (59, Lift)];
    let touched = [(2_740, Touch(finger)), (348, Freeze(300)), (934, Touch(RIGHT))];
    holds(&[&begun[..], &stood, &touched].concat());
}

#[test]
fn what_a_full_terminal_did_not_take_was_not_read() {
    let finger = Contact { x_mm: -12.8, y_mm: -6.4, fx_n: -0.7, fy_n: 0.4, fz_n: 0.8 };
    let anew = |time_us, is_flagged, offset| Restart { time_us, is_flagged, offset, text: 2 };
    let begun = [(0, Rate(200)), (0, Mend), (1, Touch(finger)), (0, Freeze(3_000)), (425, Touch(RIGHT))];
    let first =
        [(31, anew(4_294_780_715, false, 377_673)), (1_000, Touch(RIGHT)), (0, Event::SequenceBits(8))];
    holds(&[&begun[..], &first, &[(2_306, anew(18_446_744_073_708_760_834, true, 322_901))]].concat());
}

#[test]
fn a_pad_whose_clock_stood_while_it_was_silent_is_late_for_a_second_and_not_for_ever() {
    holds(&[
        (0, PLUG_IN),
        (0, Pace(1)),
        (1, Stall(true)),
        (1_000, Mend),
        (0, Touch(RIGHT)),
        (2_731, Stall(true)),
        (688, Stall(false)),
        (229, Lift),
        (88, Mend),
    ]);
}

#[test]
fn a_machine_that_stands_still_while_the_pad_does_measures_no_zero_under_the_finger() {
    holds(&[
        (0, PLUG_IN),
        (1_000, Touch(FINGER)),
        (0, Freeze(3_000)),
        (0, Stall(true)),
        (1_000, Stall(false)),
        (2_954, Lift),
        (76, Mend),
    ]);
    holds(&[
        (0, Mend),
        (0, Touch(RIGHT)),
        (0, Keep(true)),
        (2_647, Keep(false)),
        (0, Freeze(300)),
        (1_000, Lift),
        (0, Mend),
    ]);
}

#[test]
fn a_pad_whose_frames_are_damaged_while_its_clock_runs_away_is_not_slow() {
    let restart = |time_us, offset| Restart { time_us, is_flagged: true, offset, text: 1 };
    holds(&[
        (0, Rate(100)),
        (0, Mend),
        (401, restart(11_415_596_874_167_041_261, 87_047)),
        (275, restart(21_608_009, -187_079)),
        (804, Off(6, Stuck)),
        (1_110, Mend),
        (392, DamagePermille(300)),
        (10, Pace(20_000)),
        (0, restart(10_719_728, -37_383)),
        (256, Mend),
    ]);
}
