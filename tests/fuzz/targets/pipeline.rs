//! Any calls at any times: `Rig` checks after each that the events are balanced, and at the end that nothing is held.
#![no_main]

use tactpad_fuzz::rig::Rig;
use tactpad_fuzz::step::Step;

libfuzzer_sys::fuzz_target!(|story: (bool, Vec<Step>)| {
    let mut rig = Rig::default();
    let (rested, steps) = story;
    // Half of all pads know their zero: a mutation would find the half second of rest late.
    let rest = rested.then_some(Step::Rest);
    rest.iter().chain(&steps).for_each(|step| rig.play(step));
    rig.end();
});
