//! Which input of the converters carries which channel, and with which sign, by a few deeds whose places and directions are known roughly.
//!
//! A contact has five unknowns, so nine channels of one contact leave four equations; and a deed was meant somewhere. For a wiring P, which
//! says what each channel is sent as, a deed's readings y cost
//!
//! ```text
//! J(P) = χ²(c) + (c − m)ᵀ (C + Λ)⁻¹ (c − m)
//! ```
//!
//! where c is the contact that explains P y best, χ² what it misses, C its covariance, m the contact that was meant and Λ how exactly a hand
//! does that. To first order this is the least of both together over all contacts. Costs of deeds add up, and the wiring of the least
//! cost is the likeliest. What no wiring within [`MARGIN`] of it says otherwise is told; the rest is left open.
//!
//! There are 9! 2⁹ wirings. The search begins where channels are assigned one by one to what drawn contacts near those that were
//! meant would read (exactly, over the subsets of inputs), and goes on by all exchanges and signs of two channels, and of three of one axis or
//! one module, as long as that lowers the cost.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::deed::{Deed, PLACE_MM, SHEAR_SHARE};
use tactpad_core::pad::device::Device;
use tactpad_core::pad::field::PadField;
use tactpad_core::pad::wiring::permutation::SignedPermutation;
use tactpad_core::pipeline::contact::inverse::Inverse;
use tactpad_core::pipeline::contact::uncertainty::Noise;
use tactpad_core::quantity::{CHANNELS, Contact, MODULES, Strain};
use tactpad_numeric::linear::Factor;
use tactpad_numeric::random::SplitMix64;
use tactpad_numeric::statistics::rms;

/// Pads of a kind differ from the nominal one by this share of a reading, and by this much of the readings' size.
const SHARE: f64 = 0.15;
const ADDITIVE: f64 = 0.05;
/// Readings are brought to this size.
const SIZE_UV: f64 = 300.0;
/// A reading that is missing.
const UNTOLD_UV: f64 = 1e6;
/// With more of them missing no more channels are left than a contact has unknowns, which says nothing of the order.
const UNTOLD_MAX: usize = 3;
/// How well the force is known by the size of the readings, as a share of it.
const FORCE_SHARE: f64 = 0.5;
/// Contacts near those that were meant, from which the search begins.
const DRAWS: usize = 48;
/// Of the wirings that come of them, so many are gone on from.
const BEGINNINGS: usize = 4;
/// Beside a drawn contact, expected readings are off by so much of their size.
const DRAWN_SHARE: f64 = 0.15;
/// Wirings whose cost is within this of the least are not told apart. A contact leaves four equations of nine channels; where inputs are missing
/// fewer are left to speak against a wrong one, and the margin grows as their number falls. One sign of 200 pads with one or two
/// missing inputs is told wrong all the same.
pub const MARGIN: f64 = 10.0;
const EQUATIONS: f64 = 4.0;
/// Mean cost of a deed from which it is another pad, or where something else was done than asked. Of pads whose gains scatter by a tenth, or
/// whose plate or modules are a little different, no wrong wiring was the likeliest below 5, and the middle pad has 2.6; one with a module that
/// came half loose has 5 to 20.
pub const SOUND: f64 = 4.5;

/// Readings of a deed against the untouched pad, µV, as they are sent.
#[derive(Clone, Copy, Debug)]
pub struct DeedReading {
    /// What was asked for.
    pub deed: Deed,
    /// One for each input.
    pub uv: [f64; CHANNELS],
}

/// The wirings that explain some deeds.
#[derive(Clone, Debug)]
pub struct Order {
    /// The likeliest one.
    pub wiring: SignedPermutation,
    /// All that are not told apart from it, itself among them.
    pub alike: Vec<SignedPermutation>,
    /// Mean cost of a deed with the likeliest one.
    pub cost: f64,
}

impl Order {
    /// Whether the readings are those of the pad at all.
    pub fn is_sound(&self) -> bool {
        self.cost <= SOUND
    }

    /// What each channel is sent as, and whether reversed; `None` where wirings that are alike differ.
    pub fn told(&self) -> [Option<(usize, bool)>; CHANNELS] {
        let first = self.wiring.sources();
        let all: Vec<_> = self.alike.iter().map(SignedPermutation::sources).collect();
        std::array::from_fn(|k| {
            let agree = self.is_sound() && all.iter().all(|sources| sources[k] == first[k]);
            agree.then_some(first[k])
        })
    }

    /// The input that carries each channel; `None` where wirings that are alike differ.
    pub fn told_places(&self) -> [Option<usize>; CHANNELS] {
        let first = self.wiring.sources();
        std::array::from_fn(|k| {
            let agree = self.is_sound() && self.alike.iter().all(|it| it.sources()[k].0 == first[k].0);
            agree.then_some(first[k].0)
        })
    }

    /// What is known to be wrong, and nothing else: a sign that is open counts as right, and where it is open which of the inputs that
    /// tell something carries what, nothing is changed. Inputs that are not `told` are where the likeliest wiring has them.
    pub fn told_wiring(&self, told: &[bool; CHANNELS]) -> SignedPermutation {
        let places = self.told_places();
        let sources = self.wiring.sources();
        if (0..CHANNELS).any(|k| places[k].is_none() && told[sources[k].0]) {
            return SignedPermutation::IDENTITY;
        }
        let signs = self.told();
        let sign = |k: usize| if signs[k].is_some_and(|(_, is_reversed)| is_reversed) { -1.0 } else { 1.0 };
        let from = sources.map(|(sent, _)| sent);
        SignedPermutation::new(from, std::array::from_fn(sign)).unwrap_or(SignedPermutation::IDENTITY)
    }

    /// Whether it is known of each input that is `told` what it carries. Of the others nobody can know the sign.
    pub fn is_decided(&self, told: &[bool; CHANNELS]) -> bool {
        let known = self.told();
        self.wiring.sources().iter().zip(known).all(|((sent, _), known)| known.is_some() || !told[*sent])
    }
}

/// Finds the wiring of a pad.
pub struct OrderSearch<'p> {
    device: &'p Device,
    field: &'p PadField,
    moves: Vec<SignedPermutation>,
}

impl<'p> OrderSearch<'p> {
    /// For a pad with this field.
    pub fn new(device: &'p Device, field: &'p PadField) -> Self {
        Self { device, field, moves: moves() }
    }

    /// The wiring by these deeds; inputs that are not `told` do not count. `None` where nothing was done,
    /// too few inputs tell anything, or no contact explains it.
    pub fn wiring(&self, readings: &[DeedReading], told: &[bool; CHANNELS]) -> Option<Order> {
        let deeds: Vec<ScaledDeed> =
            readings.iter().filter_map(|it| ScaledDeed::of(it, told, self.device, self.field)).collect();
        let untold = told.iter().filter(|told| !**told).count();
        if deeds.is_empty() || untold > UNTOLD_MAX {
            return None;
        }
        let costs = Costs { deeds: &deeds, decoders: self.decoders(told), told };
        let mut known: Vec<(f64, SignedPermutation)> = Vec::new();
        let mut beginnings = costs.all(&self.beginnings(&deeds, told));
        beginnings.sort_by(|one, other| one.0.total_cmp(&other.0));
        for begin in beginnings.into_iter().take(BEGINNINGS) {
            self.descend(&costs, begin, &mut known);
        }
        known.sort_by(|one, other| one.0.total_cmp(&other.0));
        let margin = MARGIN * EQUATIONS / (EQUATIONS - untold as f64);
        let (least, wiring) = *known.first().filter(|it| it.0.is_finite())?;
        let alike: Vec<_> =
            known.iter().filter(|(cost, _)| cost - least <= margin).map(|(_, wiring)| *wiring).collect();
        Some(Order { wiring, alike, cost: least / deeds.len() as f64 })
    }

    /// Goes down from one wiring; all that was looked at is `known`.
    fn descend(
        &self,
        costs: &Costs<'_>,
        begin: (f64, SignedPermutation),
        known: &mut Vec<(f64, SignedPermutation)>,
    ) {
        let mut best = begin;
        loop {
            let near: Vec<SignedPermutation> = self.moves.iter().map(|it| it.after(&best.1)).collect();
            let near = costs.all(&near);
            let next = near.iter().copied().min_by(|one, other| one.0.total_cmp(&other.0));
            for one in near.into_iter().chain([best]) {
                if known.iter().all(|(_, wiring)| *wiring != one.1) {
                    known.push(one);
                }
            }
            match next {
                Some(next) if next.0 < best.0 => best = next,
                _ => return,
            }
        }
    }

    /// Decoders for each set of channels whose readings are missing.
    fn decoders(&self, told: &[bool; CHANNELS]) -> BTreeMap<usize, Inverse> {
        let untold = told.iter().filter(|told| !**told).count();
        let sets = (0..1_usize << CHANNELS).filter(|set| set.count_ones() as usize == untold);
        let decoder = |set: usize| {
            let additive = |k: usize| if set >> k & 1 == 1 { UNTOLD_UV } else { ADDITIVE * SIZE_UV };
            let noise = Noise::of_channels(std::array::from_fn(additive), [SHARE; CHANNELS]);
            (set, Inverse::new(self.field.signals.clone(), noise))
        };
        sets.collect::<Vec<_>>().into_par_iter().map(decoder).collect()
    }

    /// Wirings to begin with.
    fn beginnings(&self, deeds: &[ScaledDeed], told: &[bool; CHANNELS]) -> Vec<SignedPermutation> {
        let mut random = SplitMix64::named(0, "channel order");
        let mut found: Vec<SignedPermutation> = vec![SignedPermutation::IDENTITY];
        for draw in 0..DRAWS {
            let expected: Vec<[f64; CHANNELS]> = deeds
                .iter()
                .map(|deed| {
                    let mut normal = || if draw == 0 { 0.0 } else { f64::from(random.normal()) };
                    let Contact { x_mm, y_mm, fx_n, fy_n, fz_n } = deed.meant;
                    let force_n = f64::from(fz_n);
                    let near = Contact {
                        x_mm: x_mm + (PLACE_MM * normal()) as f32,
                        y_mm: y_mm + (PLACE_MM * normal()) as f32,
                        fx_n: fx_n + (SHEAR_SHARE * force_n * normal()) as f32,
                        fy_n: fy_n + (SHEAR_SHARE * force_n * normal()) as f32,
                        fz_n,
                    };
                    let uv = self.field.signals.strain_uv(&near).uv.map(f64::from);
                    let size = rms(uv);
                    uv.map(|uv| SIZE_UV * uv / size)
                })
                .collect();
            let wiring = assigned(deeds, &expected, told);
            found.extend(wiring.filter(|it| !found.contains(it)));
        }
        found
    }
}

/// A deed whose readings are brought to one size.
struct ScaledDeed {
    uv: [f64; CHANNELS],
    /// The contact that was meant, with a force that makes readings of that size.
    meant: Contact,
}

impl ScaledDeed {
    fn of(reading: &DeedReading, told: &[bool; CHANNELS], device: &Device, field: &PadField) -> Option<Self> {
        let uv: [f64; CHANNELS] = std::array::from_fn(|j| if told[j] { reading.uv[j] } else { 0.0 });
        let size = rms(uv);
        let meant = reading.deed.meant(device);
        let unit = rms(field.signals.strain_uv(&meant).uv.map(f64::from));
        if !(size > 0.0 && size.is_finite() && unit > 0.0) {
            return None;
        }
        let force = (SIZE_UV / unit) as f32;
        let Contact { fx_n, fy_n, fz_n, .. } = meant;
        let meant = Contact { fx_n: force * fx_n, fy_n: force * fy_n, fz_n: force * fz_n, ..meant };
        Some(Self { uv: uv.map(|uv| SIZE_UV * uv / size), meant })
    }
}

/// What wirings cost.
struct Costs<'s> {
    deeds: &'s [ScaledDeed],
    decoders: BTreeMap<usize, Inverse>,
    told: &'s [bool; CHANNELS],
}

impl Costs<'_> {
    fn all(&self, wirings: &[SignedPermutation]) -> Vec<(f64, SignedPermutation)> {
        wirings.par_iter().map(|wiring| (self.of(wiring), *wiring)).collect()
    }

    fn of(&self, wiring: &SignedPermutation) -> f64 {
        let untold = wiring.sources().into_iter().enumerate().filter(|(_, (sent, _))| !self.told[*sent]);
        let set = untold.map(|(k, _)| 1 << k).sum::<usize>();
        let Some(decoder) = self.decoders.get(&set) else { return f64::INFINITY };
        self.deeds.iter().map(|deed| cost(decoder, wiring, deed)).sum()
    }
}

fn cost(decoder: &Inverse, wiring: &SignedPermutation, deed: &ScaledDeed) -> f64 {
    let uv = wiring.of(&deed.uv).map(|uv| uv as f32);
    let Some(found) = decoder.estimate(&Strain { uv }) else { return f64::INFINITY };
    let numbers = |it: &Contact| [it.x_mm, it.y_mm, it.fx_n, it.fy_n, it.fz_n].map(f64::from);
    let (is, meant) = (numbers(&found.contact), numbers(&deed.meant));
    let force_n = meant[4];
    let shear_n = SHEAR_SHARE * force_n;
    let hand = [PLACE_MM, PLACE_MM, shear_n, shear_n, FORCE_SHARE * force_n];
    let mut covariance = found.covariance;
    (0..5).for_each(|i| covariance[i][i] += hand[i] * hand[i]);
    let missed: [f64; 5] = std::array::from_fn(|i| is[i] - meant[i]);
    let Some(factor) = Factor::of(&covariance) else { return f64::INFINITY };
    found.misfit + factor.solve_lower(&missed).iter().map(|part| part * part).sum::<f64>()
}

/// The wiring that brings what was read closest to what was expected: each set of inputs by the best way to have given it to the first
/// channels.
fn assigned(
    deeds: &[ScaledDeed],
    expected: &[[f64; CHANNELS]],
    told: &[bool; CHANNELS],
) -> Option<SignedPermutation> {
    let cost = |channel: usize, input: usize, sign: f64| -> f64 {
        let missed = deeds.iter().zip(expected).map(|(deed, expected)| {
            let variance = (SHARE * expected[channel]).powi(2) + (DRAWN_SHARE * SIZE_UV).powi(2);
            (sign * deed.uv[input] - expected[channel]).powi(2) / variance
        });
        if told[input] { missed.sum() } else { 0.0 }
    };
    let mut best = vec![(f64::INFINITY, [0_usize; CHANNELS], [1.0; CHANNELS]); 1 << CHANNELS];
    best[0].0 = 0.0;
    for set in 0..best.len() {
        let (before, from, sign) = best[set];
        let channel = set.count_ones() as usize;
        for input in (0..CHANNELS).filter(|input| set >> input & 1 == 0) {
            let [plus, minus] = [1.0, -1.0].map(|sign| cost(channel, input, sign));
            let (more, own) = if minus < plus { (minus, -1.0) } else { (plus, 1.0) };
            let to = &mut best[set | 1 << input];
            if before + more < to.0 {
                *to = (before + more, from, sign);
                (to.1[channel], to.2[channel]) = (input, own);
            }
        }
    }
    let (_, from, sign) = *best.last()?;
    SignedPermutation::new(from, sign)
}

/// Changes of a wiring from one to those near it.
fn moves() -> Vec<SignedPermutation> {
    let mut all = SignedPermutation::single_mistakes();
    let pairs = (0..CHANNELS).flat_map(|one| (one + 1..CHANNELS).map(move |other| vec![one, other]));
    let axes = CHANNELS / MODULES;
    let of_axis = (0..axes).map(|axis| (0..MODULES).map(|module| axes * module + axis).collect());
    let of_module = (0..MODULES).map(|module| (0..axes).map(|axis| axes * module + axis).collect());
    let groups: Vec<Vec<usize>> = pairs.chain(of_axis).chain(of_module).collect();
    for group in groups {
        for order in orders(&group) {
            for signs in 0..1_usize << group.len() {
                let mut from: [usize; CHANNELS] = std::array::from_fn(|k| k);
                let mut sign = [1.0; CHANNELS];
                for (at, (k, source)) in group.iter().zip(&order).enumerate() {
                    from[*k] = *source;
                    sign[*k] = if signs >> at & 1 == 1 { -1.0 } else { 1.0 };
                }
                let change = SignedPermutation::new(from, sign);
                all.extend(change.filter(|it| *it != SignedPermutation::IDENTITY && !all.contains(it)));
            }
        }
    }
    all
}

/// All orders of two or three things.
fn orders(items: &[usize]) -> Vec<Vec<usize>> {
    match *items {
        [a, b] => vec![vec![a, b], vec![b, a]],
        [a, b, c] => {
            [[a, b, c], [a, c, b], [b, a, c], [b, c, a], [c, a, b], [c, b, a]].map(Vec::from).to_vec()
        }
        _ => vec![items.to_vec()],
    }
}
