//! The map from contacts, as the readings tell them, to labels, as somebody wrote them.
//!
//! Written places are w = s M p + b with a size s, a map M of the plane and an offset b, written forces v S M F. Any two contacts give a map of
//! places; the one that most contacts agree with is taken (random sample consensus, M. A. Fischler, R. C. Bolles, Communications of the ACM 24
//! (1981) 381), and among these contacts the size of the forces, their map and the sign of Fz the same way.

use super::decoding::DecodedContact;
use tactpad_core::tables::convention::PlaneMap;
use tactpad_core::tables::measured::Label;
use tactpad_numeric::random::SplitMix64;
use tactpad_numeric::statistics::median;

/// Pairs of contacts that are tried.
const DRAWS: usize = 400;
/// Contacts of a pair are so far apart at least.
const APART_MM: f64 = 10.0;
/// Decoded by another pad's field, contacts are off by less than this.
const TOLERANCE_MM: f64 = 5.0;
/// A stage is off by no more than this.
const OFFSET_MM: f64 = 6.0;
/// Written forces agree within this factor of their size …
const FORCE_FACTOR: f64 = 1.6;
/// Frames that are turned against each other by less are one.
const OTHER_FRAME_DEG: f64 = 25.0;
/// A contact that misses its label by so many times as much has another one.
const STRANGE: f64 = 3.0;
/// … and within this angle of their direction in the plane, where that part is no less than this share of the whole.
const DIRECTION_DEG: f64 = 40.0;
const SHEAR_SHARE: f64 = 0.15;

/// A contact, and what was written of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WrittenContact {
    /// Its row.
    pub(crate) row: usize,
    pub(crate) decoded: DecodedContact,
    pub(crate) label: Label,
}

/// How labels follow contacts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mapping {
    /// Millimetres in a unit of written places, 1/s, and the map M.
    pub(crate) unit_mm: f64,
    pub(crate) place: PlaneMap,
    /// b, in written units.
    offset: [f64; 2],
    /// Newtons in a unit of written forces, 1/v, the map S M of the plane's, and whether Fz is reversed.
    pub(crate) unit_n: f64,
    pub(crate) force: PlaneMap,
    pub(crate) is_fz_reversed: bool,
}

impl WrittenContact {
    fn place(&self) -> [f64; 2] {
        [self.label.x_mm, self.label.y_mm]
    }

    fn shear(&self) -> [f64; 2] {
        [self.label.fx_n, self.label.fy_n]
    }

    fn decoded_shear(&self) -> [f64; 2] {
        [self.decoded.force_n[0], self.decoded.force_n[1]]
    }

    /// Newtons in a unit of the written force, by this contact.
    fn unit_n(&self) -> f64 {
        self.decoded.resultant_n() / self.label.resultant_n()
    }

    /// Whether both forces have a part in the plane.
    fn is_sheared(&self) -> bool {
        length(self.shear()) > SHEAR_SHARE * self.label.resultant_n()
            && length(self.decoded_shear()) > SHEAR_SHARE * self.decoded.resultant_n()
    }

    /// Whether both forces have a part out of the plane.
    fn is_pressed(&self) -> bool {
        self.label.fz_n.abs() > SHEAR_SHARE * self.label.resultant_n()
    }
}

fn length([x, y]: [f64; 2]) -> f64 {
    libm::hypot(x, y)
}

fn angle_deg([x, y]: [f64; 2]) -> f64 {
    libm::atan2(y, x).to_degrees()
}

fn minus(one: [f64; 2], other: [f64; 2]) -> [f64; 2] {
    [one[0] - other[0], one[1] - other[1]]
}

/// The map that takes a direction to another one.
fn turned(from: [f64; 2], to: [f64; 2], is_mirrored: bool) -> PlaneMap {
    // R(a) K turns a direction by a less its own angle.
    let from_deg = angle_deg(from);
    PlaneMap::new(angle_deg(to) - if is_mirrored { -from_deg } else { from_deg }, is_mirrored)
}

/// The angle between two directions, degrees.
pub(crate) fn between_deg(one: f64, other: f64) -> f64 {
    let apart = (one - other).rem_euclid(360.0);
    apart.min(360.0 - apart)
}

impl Mapping {
    /// The mapping that most contacts agree with; `None` where no two agree.
    pub(crate) fn of(contacts: &[WrittenContact]) -> Option<Self> {
        let mut random = SplitMix64::named(contacts.len() as u64, "label conventions");
        let count = contacts.len() as u64;
        let mut draw = || contacts.get((random.next_bits() % count.max(1)) as usize);
        let mut best: Option<(usize, f64, Self)> = None;
        for _ in 0..DRAWS {
            let (one, other) = (draw()?, draw()?);
            for is_mirrored in [false, true] {
                let Some(places) = Self::of_places(one, other, is_mirrored) else { continue };
                let missed = contacts.iter().filter_map(|contact| places.place_missed_mm(contact));
                let missed: Vec<f64> = missed.filter(|mm| *mm < TOLERANCE_MM).collect();
                let sum: f64 = missed.iter().sum();
                let is_better = best.as_ref().is_none_or(|(agreed, missed_mm, _)| {
                    missed.len() > *agreed || (missed.len() == *agreed && sum < *missed_mm)
                });
                if is_better {
                    best = Some((missed.len(), sum, places));
                }
            }
        }
        let (.., places) = best?;
        let agreeing: Vec<&WrittenContact> = contacts.iter().filter(|it| places.has_place(it)).collect();
        Some(places.refined(&agreeing).with_forces(&agreeing))
    }

    fn of_places(one: &WrittenContact, other: &WrittenContact, is_mirrored: bool) -> Option<Self> {
        let decoded = minus(other.decoded.place_mm, one.decoded.place_mm);
        let written = minus(other.place(), one.place());
        if length(decoded) < APART_MM || length(written) <= 0.0 {
            return None;
        }
        let size = length(written) / length(decoded);
        let place = turned(decoded, written, is_mirrored);
        let offset = minus(one.place(), place.of(one.decoded.place_mm).map(|mm| size * mm));
        (length(offset) < OFFSET_MM * size).then_some(Self {
            unit_mm: 1.0 / size,
            place,
            offset,
            unit_n: 1.0,
            force: place,
            is_fz_reversed: false,
        })
    }

    /// How far a contact is from what its label says, mm.
    pub(crate) fn place_missed_mm(&self, contact: &WrittenContact) -> Option<f64> {
        let expected = self.place.of(contact.decoded.place_mm).map(|mm| mm / self.unit_mm);
        let missed = minus(minus(contact.place(), self.offset), expected);
        Some(length(missed) * self.unit_mm).filter(|mm| mm.is_finite())
    }

    fn has_place(&self, contact: &WrittenContact) -> bool {
        self.place_missed_mm(contact).is_some_and(|mm| mm < TOLERANCE_MM)
    }

    /// The closest mapping of the same kind to these places: with places as complex numbers, w = a p + b, or w = a p̄ + b mirrored.
    fn refined(self, contacts: &[&WrittenContact]) -> Self {
        let mean = |of: &dyn Fn(&WrittenContact) -> [f64; 2]| {
            let sum = contacts.iter().map(|it| of(it)).fold([0.0; 2], |[x, y], [dx, dy]| [x + dx, y + dy]);
            sum.map(|sum| sum / contacts.len().max(1) as f64)
        };
        let decoded = |it: &WrittenContact| {
            let [x, y] = it.decoded.place_mm;
            if self.place.is_mirrored() { [x, -y] } else { [x, y] }
        };
        let [middle, written_middle] = [mean(&decoded), mean(&WrittenContact::place)];
        let (mut product, mut square) = ([0.0; 2], 0.0);
        for contact in contacts {
            let ([x, y], [wx, wy]) =
                (minus(decoded(contact), middle), minus(contact.place(), written_middle));
            // w p̄
            product = [product[0] + wx * x + wy * y, product[1] + wy * x - wx * y];
            square += x * x + y * y;
        }
        if square <= 0.0 || length(product) <= 0.0 {
            return self;
        }
        let size = length(product) / square;
        let turn = PlaneMap::new(angle_deg(product), false);
        Self {
            unit_mm: 1.0 / size,
            place: PlaneMap::new(angle_deg(product), self.place.is_mirrored()),
            offset: minus(written_middle, turn.of(middle).map(|mm| size * mm)),
            ..self
        }
    }

    /// With the forces of these contacts.
    fn with_forces(self, contacts: &[&WrittenContact]) -> Self {
        let units: Vec<f64> =
            contacts.iter().map(|it| it.unit_n()).filter(|unit| unit.is_finite() && *unit > 0.0).collect();
        let agree = |unit: f64| units.iter().copied().filter(move |it| is_within(it / unit, FORCE_FACTOR));
        let most = units.iter().copied().max_by_key(|unit| agree(*unit).count());
        let unit_n = most.and_then(|unit| median(agree(unit))).unwrap_or(1.0);
        let of_size = |it: &&&WrittenContact| is_within(it.unit_n() / unit_n, FORCE_FACTOR);
        let contacts: Vec<&&WrittenContact> = contacts.iter().filter(of_size).collect();
        let pressed: Vec<f64> = contacts
            .iter()
            .filter(|it| it.is_pressed())
            .map(|it| (it.label.fz_n * it.decoded.force_n[2]).signum())
            .collect();
        let is_fz_reversed = pressed.iter().sum::<f64>() < 0.0;
        let with_unit = Self { unit_n, is_fz_reversed, ..self };
        let sheared: Vec<&&&WrittenContact> = contacts.iter().filter(|it| it.is_sheared()).collect();
        let agreeing = |map: PlaneMap| {
            let candidate = Self { force: map, ..with_unit };
            sheared.iter().copied().filter(move |it| candidate.direction_missed_deg(it) < DIRECTION_DEG)
        };
        let maps = sheared.iter().flat_map(|it| {
            [false, true].map(|is_mirrored| turned(it.decoded_shear(), it.shear(), is_mirrored))
        });
        // Of maps that agree with as many the one of the places comes first.
        let maps = std::iter::once(self.place).chain(maps);
        let Some(map) = first_max(maps, |map| agreeing(*map).count()) else {
            return with_unit;
        };
        let mut sum = [0.0; 2];
        for contact in agreeing(map) {
            let [dx, dy] = contact.decoded_shear();
            let decoded = if map.is_mirrored() { [dx, -dy] } else { [dx, dy] };
            let [wx, wy] = contact.shear();
            sum = [sum[0] + wx * decoded[0] + wy * decoded[1], sum[1] + wy * decoded[0] - wx * decoded[1]];
        }
        let force = if length(sum) > 0.0 { PlaneMap::new(angle_deg(sum), map.is_mirrored()) } else { map };
        Self { force, ..with_unit }
    }

    fn direction_missed_deg(&self, contact: &WrittenContact) -> f64 {
        between_deg(angle_deg(self.force.of(contact.decoded_shear())), angle_deg(contact.shear()))
    }

    /// Whether a contact's label is written so.
    pub(crate) fn agrees(&self, contact: &WrittenContact) -> bool {
        let is_of_size = is_within(contact.unit_n() / self.unit_n, FORCE_FACTOR);
        let is_of_sign = !contact.is_pressed()
            || (contact.label.fz_n * contact.decoded.force_n[2] < 0.0) == self.is_fz_reversed;
        let is_of_direction =
            !contact.is_sheared() || self.direction_missed_deg(contact) < 1.5 * DIRECTION_DEG;
        self.has_place(contact) && is_of_size && is_of_sign && is_of_direction
    }
}

impl Mapping {
    /// Whether another one is no other convention, but the same one seen on other contacts.
    pub(crate) fn is_like(&self, other: &Self) -> bool {
        let are_near = |one: PlaneMap, other: PlaneMap| {
            one.is_mirrored() == other.is_mirrored()
                && between_deg(one.turn_deg(), other.turn_deg()) < OTHER_FRAME_DEG
        };
        are_near(self.place, other.place)
            && are_near(self.force, other.force)
            && self.is_fz_reversed == other.is_fz_reversed
            && is_within(self.unit_mm / other.unit_mm, FORCE_FACTOR)
            && is_within(self.unit_n / other.unit_n, FORCE_FACTOR * FORCE_FACTOR)
    }

    /// Whether a contact is far from what its label says.
    pub(crate) fn contradicts(&self, contact: &WrittenContact) -> bool {
        let is_elsewhere = self.place_missed_mm(contact).is_none_or(|mm| mm > STRANGE * TOLERANCE_MM);
        is_elsewhere || !is_within(contact.unit_n() / self.unit_n, STRANGE)
    }
}

fn is_within(ratio: f64, factor: f64) -> bool {
    ratio > 1.0 / factor && ratio < factor
}

/// The first of those with the largest key.
fn first_max<T>(items: impl Iterator<Item = T>, key: impl Fn(&T) -> usize) -> Option<T> {
    let larger = |best: Option<(usize, T)>, item: T| {
        let of = key(&item);
        if best.as_ref().is_some_and(|(most, _)| *most >= of) { best } else { Some((of, item)) }
    };
    items.fold(None, larger).map(|(_, item)| item)
}
