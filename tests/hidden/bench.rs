//! The order and the signs of the channels, found by a few deeds on pads whose fields are the independent ones: random orders, signs, gains,
//! crosstalk, noise, and hands that miss places, forces and directions.

use std::array::from_fn;

use tactpad::lab::bench::deed::{Deed, PlateAxis};
use tactpad::lab::bench::order::{DeedReading, Order, OrderSearch};
use tactpad::pad::device::Device;
use tactpad::pad::field::PadField;
use tactpad::pad::wiring::permutation::SignedPermutation;
use tactpad::quantity::CHANNELS;

use crate::fields::{self, Influence, View};
use crate::random::Random;

/// A pad, how it is wired, and the hand that presses it.
struct Bench {
    random: Random,
    view: View<'static>,
    gains: [f64; CHANNELS],
    crosstalk: Vec<(usize, usize, f64)>,
    noise_uv: f64,
    /// What each channel is sent as.
    wiring: SignedPermutation,
    /// Inputs that tell nothing.
    dead: Vec<usize>,
}

impl Bench {
    fn new(seed: u64) -> Self {
        let mut random = Random::new(seed, "bench");
        let tables = [
            &fields::NOMINAL,
            &fields::THICK_PLATE,
            &fields::MOVED,
            &fields::TURNED,
            &fields::SOFT_FRAME,
            &fields::OPEN_FRAME,
        ];
        let at = random.below(tables.len());
        let home = [0, 0, 0, 1, 2, 0][at];
        let view = View { table: tables[at], home, target: random.below(3), mirrored: random.unit() < 0.5 };
        let gains = from_fn(|_| 1.0 + 0.1 * random.normal().clamp(-2.0, 2.0));
        let crosstalk = (0..6).map(|_| (random.below(9), random.below(9), random.between(-0.03, 0.03)));
        let crosstalk = crosstalk.collect();
        let noise_uv = random.between(1.0, 20.0);
        let wiring = drawn(&mut random);
        Self { random, view, gains, crosstalk, noise_uv, wiring, dead: Vec::new() }
    }

    /// What is sent of a contact.
    fn sent(&mut self, place: [f64; 2], force: [f64; 3]) -> [f64; CHANNELS] {
        let field: Influence = self.view.at(place);
        let own: [f64; CHANNELS] =
            from_fn(|k| self.gains[k] * (0..3).map(|axis| field[k][axis] * force[axis]).sum::<f64>());
        let mut read = own;
        for (into, from, share) in self.crosstalk.iter().filter(|it| it.0 != it.1) {
            read[*into] += share * own[*from];
        }
        let mut sent = self.wiring.inverse().of(&read);
        for (input, uv) in sent.iter_mut().enumerate() {
            *uv = if self.dead.contains(&input) { 0.0 } else { *uv + self.noise_uv * self.random.normal() };
        }
        sent
    }

    /// A hand does what it is asked, about.
    fn doing(&mut self, deed: Deed) -> DeedReading {
        let random = &mut self.random;
        let force = random.between(0.8, 5.0);
        let near = |random: &mut Random, mm: f64| mm * random.normal().clamp(-2.0, 2.0);
        let (middle, along) = match deed {
            Deed::Press { module } => {
                let angle = 120_f64.to_radians() * module as f64;
                ([20.0 * angle.cos(), 20.0 * angle.sin()], [0.0; 2])
            }
            Deed::Push { axis } => {
                let push = random.between(0.3, 0.8);
                ([0.0; 2], if axis == PlateAxis::X { [push, 0.0] } else { [0.0, push] })
            }
        };
        let place = middle.map(|mm| mm + near(random, 3.0));
        let reach = place[0].hypot(place[1]);
        let place = place.map(|mm| mm * (28.0 / reach).min(1.0));
        let shear = along.map(|share| force * (share + 0.12 * random.normal().clamp(-2.0, 2.0)));
        DeedReading { deed, uv: self.sent(place, [shear[0], shear[1], force]) }
    }

    /// All deeds once more, and the order by these and those before.
    fn order(&mut self, search: &OrderSearch<'_>, readings: &mut Vec<DeedReading>) -> Order {
        readings.extend(Deed::ALL.map(|deed| self.doing(deed)));
        search.wiring(readings, &self.told()).unwrap()
    }

    fn told(&self) -> [bool; CHANNELS] {
        from_fn(|input| !self.dead.contains(&input))
    }
}

/// Half of them a few mistakes, half any order with any signs.
fn drawn(random: &mut Random) -> SignedPermutation {
    let mut from: [usize; CHANNELS] = from_fn(|k| k);
    let mut sign = [1.0; CHANNELS];
    if random.unit() < 0.5 {
        (1..CHANNELS).rev().for_each(|k| from.swap(k, random.below(k + 1)));
        sign = from_fn(|_| random.sign());
    } else {
        for _ in 0..random.below(4) {
            let (one, other) = (random.below(9), random.below(9));
            if random.unit() < 0.5 { from.swap(one, other) } else { sign[one] = -sign[one] }
        }
    }
    SignedPermutation::new(from, sign).unwrap()
}

/// How many pads were told right, left open in part, and told wrong.
#[derive(Clone, Copy, Debug, Default)]
struct Score {
    right: usize,
    open: usize,
    wrong: usize,
}

impl Score {
    fn of(seeds: std::ops::Range<u64>, dead: impl Fn(&mut Random) -> usize) -> Self {
        let (device, field) = (Device::nominal(), PadField::nominal());
        let search = OrderSearch::new(&device, &field);
        let mut score = Self::default();
        for seed in seeds {
            let mut bench = Bench::new(seed);
            let dead = dead(&mut bench.random);
            bench.dead = (0..dead).map(|_| bench.random.below(CHANNELS)).collect();
            let mut readings = Vec::new();
            let mut order = bench.order(&search, &mut readings);
            if !order.is_decided(&bench.told()) {
                order = bench.order(&search, &mut readings);
            }
            let told = order.told();
            let truth = bench.wiring.sources();
            // Of a channel whose input is dead nobody knows the sign.
            let is_open = |channel: usize| told[channel].is_none() && !bench.dead.contains(&truth[channel].0);
            let is_wrong = |channel: usize| told[channel].is_some_and(|told| told != truth[channel]);
            if (0..CHANNELS).any(is_wrong) {
                println!("seed {seed}: told {told:?}, and is {truth:?}");
                score.wrong += 1;
            } else if (0..CHANNELS).any(is_open) {
                score.open += 1;
            } else {
                score.right += 1;
            }
        }
        println!("{score:?}");
        score
    }
}

#[test]
fn any_order_and_any_signs_are_found_or_left_open_and_never_told_wrong() {
    let score = Score::of(0..80, |_| 0);
    assert_eq!(score.wrong, 0, "{score:?}");
    // One pad in six has a module that came half loose: its presses are those of no sound pad.
    assert!(score.right >= 60, "{score:?}");
}

#[test]
fn with_inputs_that_tell_nothing_the_others_are_found_or_left_open() {
    let score = Score::of(10_000..10_024, |random| 1 + random.below(2));
    assert_eq!(score.wrong, 0, "{score:?}");
}

#[test]
#[ignore = "proof: 160 s: misses none told wrong of a thousand pads: one sign of 200 pads with missing inputs is"]
fn a_thousand_pads_are_found_or_left_open() {
    let whole = Score::of(20_000..20_800, |_| 0);
    let partly = Score::of(30_000..30_200, |random| 1 + random.below(2));
    assert_eq!([whole.wrong, partly.wrong], [0, 0], "{whole:?} {partly:?}");
    assert!(whole.right >= 620, "{whole:?}");
}

#[test]
fn presses_at_other_places_than_asked_are_no_proof() {
    let (device, field) = (Device::nominal(), PadField::nominal());
    let search = OrderSearch::new(&device, &field);
    for seed in 0..16 {
        let mut bench = Bench::new(seed);
        bench.wiring = SignedPermutation::IDENTITY;
        let told = [true; CHANNELS];
        // Nobody pressed: noise alone.
        let noise = Deed::ALL.map(|deed| DeedReading { deed, uv: bench.sent([0.0; 2], [0.0; 3]) });
        let order = search.wiring(&noise, &told).unwrap();
        assert!(!order.is_decided(&told), "seed {seed}: {order:?}");
        // All five in the middle, straight down.
        let middle = Deed::ALL.map(|deed| DeedReading { deed, uv: bench.sent([0.0; 2], [0.0, 0.0, 3.0]) });
        let order = search.wiring(&middle, &told).unwrap();
        let wrong =
            order.told().into_iter().enumerate().any(|(k, told)| told.is_some_and(|it| it != (k, false)));
        assert!(!wrong, "seed {seed}: {:?}", order.told());
    }
}
