//! What no reading tells apart: a frame of labels and a wiring that change the readings alike.
//!
//! A pad of three modules is the same after a third of a turn, as its mirror image, and with all forces reversed, but for the order and the
//! signs of its channels: s(g c) = P s(c) for contacts c, with a map g of contacts and a signed permutation P.

use tactpad_core::pad::device::Device;
use tactpad_core::pad::field::PadField;
use tactpad_core::pad::wiring::permutation::SignedPermutation;
use tactpad_core::quantity::{CHANNELS, Contact};
use tactpad_core::tables::convention::{Frame, LabelConvention, PlaneMap, Sign};
use tactpad_core::tables::measured::Label;
use tactpad_core::tables::units::Units;
use tactpad_numeric::random::SplitMix64;
use tactpad_numeric::statistics::correlation;

/// Contacts by which readings are compared.
const CONTACTS: usize = 80;
/// Readings that are one thing correlate by so much at least.
const ALIKE: f64 = 0.98;
/// They lie this near to the middle, as a share of the plate's radius.
const REACH: f64 = 0.8;

/// The pad's readings of contacts, without their unit.
pub(crate) struct Readings<'f> {
    field: &'f PadField,
    contacts: Vec<Label>,
}

impl<'f> Readings<'f> {
    pub(crate) fn new(device: &Device, field: &'f PadField) -> Self {
        let mut random = SplitMix64::named(0, "symmetries");
        let reach_mm = REACH * device.plate.radius_mm();
        let mut uniform = || f64::from(random.uniform());
        let contact = |_| {
            let (radius_mm, angle) = (reach_mm * uniform().abs().sqrt(), std::f64::consts::PI * uniform());
            Label {
                x_mm: radius_mm * libm::cos(angle),
                y_mm: radius_mm * libm::sin(angle),
                fx_n: uniform(),
                fy_n: uniform(),
                fz_n: 2.0 + uniform(),
            }
        };
        Self { field, contacts: (0..CONTACTS).map(contact).collect() }
    }

    pub(crate) fn of(&self, contact: &Label) -> [f64; CHANNELS] {
        self.field.signals.strain_uv(&Contact::from(*contact)).uv.map(f64::from)
    }

    /// P of s(g c) = P s(c), where there is one. g is what a convention means by a label.
    pub(crate) fn permutation(&self, convention: &LabelConvention) -> Option<SignedPermutation> {
        let columns = |readings: Vec<[f64; CHANNELS]>| -> [Vec<f64>; CHANNELS] {
            std::array::from_fn(|k| readings.iter().map(|uv| uv[k]).collect())
        };
        let before = columns(self.contacts.iter().map(|it| self.of(it)).collect());
        let after = columns(self.contacts.iter().map(|it| self.of(&convention.meant(it))).collect());
        let (mut from, mut sign) = ([0; CHANNELS], [1.0; CHANNELS]);
        for k in 0..CHANNELS {
            let alike = before.iter().map(|column| correlation(&after[k], column)).enumerate();
            let (channel, r) = alike.max_by(|one, other| one.1.abs().total_cmp(&other.1.abs()))?;
            if r.abs() < ALIKE {
                return None;
            }
            (from[k], sign[k]) = (channel, r.signum());
        }
        SignedPermutation::new(from, sign)
    }

    /// All maps of contacts that only change the order and the signs of the channels, each with its permutation.
    pub(crate) fn symmetries(&self, device: &Device) -> Vec<(LabelConvention, SignedPermutation)> {
        let angles = device.sites.angles_deg;
        let turns = angles.map(|angle| PlaneMap::new(angle - angles[0], false));
        let mirrored = angles.map(|angle| PlaneMap::new(2.0 * angle, true));
        let of_frame = |frame: PlaneMap| {
            [false, true].map(|is_reversed| LabelConvention {
                frame: Frame(frame),
                sign: if is_reversed { reaction() } else { Sign::default() },
                units: Units::default(),
            })
        };
        let all = turns.into_iter().chain(mirrored).flat_map(of_frame);
        all.filter_map(|convention| Some((convention, self.permutation(&convention)?))).collect()
    }
}

/// The force of the plate on the finger.
pub(crate) fn reaction() -> Sign {
    Sign { plane: PlaneMap::new(180.0, false), is_fz_reversed: true }
}
