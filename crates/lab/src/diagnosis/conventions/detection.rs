//! How the labels of a table are meant, by its readings.

use super::decoding::Decoding;
use super::mapping::{Mapping, WrittenContact};
use super::stuck::StuckLabel;
use super::symmetry::Readings;
use crate::tangent::SimulatedPad;
use tactpad_core::pad::wiring::permutation::SignedPermutation;
use tactpad_core::quantity::CHANNELS;
use tactpad_core::tables::convention::{Frame, LabelConvention, PlaneMap, Sign};
use tactpad_core::tables::measured::zero::{UntouchedRows, contacts};
use tactpad_core::tables::measured::{Label, Table};
use tactpad_core::tables::units::{CHANNEL_UNITS, FORCE_UNITS, PLACE_UNITS, Units};
use tactpad_numeric::statistics::median;

/// Fewer contacts tell no convention.
const CONTACTS_MIN: usize = 12;
/// More than these tell no more; they are taken evenly.
const CONTACTS_MAX: usize = 4000;
/// Conventions hold if this share of the contacts agrees with one of them …
const AGREEING: f64 = 0.7;
/// … the first with this share, and each further one with this share of what is left, or with the other one where its rows do not
/// follow each other …
const AGREEING_WITH_ONE: f64 = 0.4;
const AGREEING_HERE_AND_THERE: f64 = 0.85;
/// … as this share of them does in a session or a day …
const FOLLOWING: f64 = 0.6;
/// … and this share of all.
const PART_MIN: f64 = 0.03;
const PARTS_MAX: usize = 3;
/// By how many rows labels may be late or early.
const SHIFT_MAX: isize = 3;
/// Frames that are turned by less are a stage that is turned.
const TURN_MIN_DEG: f64 = 15.0;
/// Angles are told in steps of this, if they are as near to one as the next.
const TURN_STEP_DEG: f64 = 30.0;
const TURN_NEAR_DEG: f64 = 8.0;
/// Sizes within these factors of 1 are no unit: places by another pad's field, forces by gains and supply.
const PLACE_SIZE: f64 = 1.35;
const FORCE_SIZE: f64 = 2.0;
/// A unit is known by its size within this factor.
const UNIT_WITHIN: f64 = 1.3;

/// Rows whose labels are meant alike.
#[derive(Clone, Debug)]
pub struct LabelPart {
    /// The rows, all of them or by which it was found.
    pub(crate) rows: Vec<usize>,
    /// How they are meant.
    pub convention: LabelConvention,
    /// Whether the forces' unit may as well be the channels'.
    pub(crate) is_channel_unit_open: bool,
}

/// How the labels of a table are meant.
#[derive(Clone, Debug)]
pub struct Conventions {
    /// The largest part first.
    pub parts: Vec<LabelPart>,
    /// By how many rows the labels are late: what row i reads is the contact whose label stands in row i + this.
    pub rows_late: isize,
    /// Rows whose readings are of one finger, but of another contact than any label of the table's kind says.
    pub strangers: Vec<usize>,
    /// Labels that stand still while the contacts go on.
    pub stuck: Vec<StuckLabel>,
    /// Contacts that tell something.
    pub(super) contacts: usize,
}

impl Conventions {
    /// Labels as the pad's frame, mm and N.
    const fn none() -> Self {
        Self { parts: Vec::new(), rows_late: 0, strangers: Vec::new(), stuck: Vec::new(), contacts: 0 }
    }

    /// How many contacts tell something.
    pub(crate) const fn contacts(&self) -> usize {
        self.contacts
    }

    /// Whether all labels are as they should be, and of their rows.
    pub fn are_default(&self) -> bool {
        self.strangers.is_empty() && self.stuck.is_empty() && self.are_meant_so()
    }

    /// Whether they are in the pad's frame, mm and N.
    pub fn are_meant_so(&self) -> bool {
        self.rows_late == 0 && self.parts.iter().all(|part| part.convention.is_default())
    }

    /// By the table's readings.
    pub fn of(table: &Table, pad: &SimulatedPad<'_>) -> Self {
        let agreement = |rows_late| Agreement::of(table, pad, rows_late);
        let as_written = agreement(0);
        if let Some(agreement) = as_written.as_ref().filter(|it| it.holds()) {
            let found = agreement.conventions(pad);
            let stuck = if found.are_meant_so() { StuckLabel::of(&agreement.all, true) } else { Vec::new() };
            return Self { stuck, ..found };
        }
        let shifts = (1..=SHIFT_MAX).flat_map(|rows| [rows, -rows]);
        if let Some(found) = shifts.filter_map(agreement).find(Agreement::holds) {
            return found.conventions(pad);
        }
        let stuck = as_written.map(|it| StuckLabel::of(&it.all, false)).unwrap_or_default();
        Self { stuck, ..Self::none() }
    }

    /// The table in the pad's frame, mm, N and µV.
    #[must_use]
    pub fn applied(&self, table: &Table) -> Table {
        let mut table = shifted(table, self.rows_late);
        let mut part_of: Vec<Option<usize>> = vec![None; table.rows.len()];
        for (at, part) in self.parts.iter().enumerate() {
            part.rows.iter().for_each(|row| part_of[*row] = Some(at));
        }
        // Rows that tell nothing are as the one before them.
        let mut present = part_of.iter().copied().flatten().next().unwrap_or_default();
        for (row, part) in table.rows.iter_mut().zip(part_of) {
            present = part.unwrap_or(present);
            let Some(part) = self.parts.get(present) else { continue };
            row.label = part.convention.meant_of(row);
            row.uv = row.uv.map(|uv| uv.map(|value| part.convention.units.uv * value));
        }
        let left_out = self.stuck.iter().flat_map(|it| &it.rows).chain(&self.strangers);
        left_out.for_each(|row| table.rows[*row].uv = None);
        table
    }
}

/// The table with each row's label from so many rows after it. Rows without lose their readings.
fn shifted(table: &Table, rows_late: isize) -> Table {
    let mut shifted = table.clone();
    if rows_late == 0 {
        return shifted;
    }
    for (at, row) in shifted.rows.iter_mut().enumerate() {
        match at.checked_add_signed(rows_late).and_then(|from| table.rows.get(from)) {
            Some(from) => {
                let own = (row.line, row.uv, row.t_s, row.temp_c);
                *row = *from;
                (row.line, row.uv, row.t_s, row.temp_c) = own;
            }
            None => row.uv = None,
        }
    }
    shifted
}

/// How the labels agree with the readings, for one order of rows.
struct Agreement {
    rows_late: isize,
    all: Vec<WrittenContact>,
    wiring: SignedPermutation,
    /// Mappings, each with the rows that agree.
    mappings: Vec<(Mapping, Vec<usize>)>,
    strangers: Vec<usize>,
}

impl Agreement {
    /// `None` where there is too little to tell, or no wiring makes contacts of the readings.
    fn of(table: &Table, pad: &SimulatedPad<'_>, rows_late: isize) -> Option<Self> {
        let mut rows = readings(table, rows_late);
        let all: Vec<[f64; CHANNELS]> = rows.iter().map(|(_, uv, _)| *uv).collect();
        let decoding = Decoding::new(pad.field, &all)?;
        rows.retain(|(_, uv, _)| decoding.is_loaded(uv));
        let loaded: Vec<[f64; CHANNELS]> = rows.iter().map(|(_, uv, _)| *uv).collect();
        if loaded.len() < CONTACTS_MIN {
            return None;
        }
        let wiring = decoding.wiring(&loaded)?;
        let contact = |(row, uv, label): (usize, [f64; CHANNELS], Label)| {
            Some(WrittenContact { row, decoded: decoding.contact(&wiring.of(&uv))?, label })
        };
        let all_contacts: Vec<WrittenContact> = rows.into_iter().filter_map(contact).collect();
        let least = (PART_MIN * all_contacts.len() as f64).max(CONTACTS_MIN as f64);
        let mut mappings: Vec<Mapping> = Vec::new();
        let mut left = all_contacts.clone();
        while mappings.len() < PARTS_MAX && left.len() as f64 >= least {
            let Some(mapping) = Mapping::of(&left) else { break };
            let (agreeing, others): (Vec<_>, Vec<_>) =
                left.iter().copied().partition(|it| mapping.agrees(it));
            let count = agreeing.len() as f64;
            if mappings.iter().any(|known| known.is_like(&mapping)) {
                break;
            }
            let is_one = mappings.is_empty() || follow_each_other(&agreeing, &all_contacts);
            let share = if is_one { AGREEING_WITH_ONE } else { AGREEING_HERE_AND_THERE };
            if count < least || count < share * left.len() as f64 {
                break;
            }
            mappings.push(mapping);
            left = others;
        }
        let mut mappings: Vec<(Mapping, Vec<usize>)> =
            mappings.into_iter().map(|it| (it, Vec::new())).collect();
        for contact in &all_contacts {
            let agreeing = mappings.iter_mut().filter(|(mapping, _)| mapping.agrees(contact));
            let missed = |mapping: &Mapping| mapping.place_missed_mm(contact).unwrap_or(f64::INFINITY);
            let closest = agreeing.min_by(|one, other| missed(&one.0).total_cmp(&missed(&other.0)));
            closest.into_iter().for_each(|(_, rows)| rows.push(contact.row));
        }
        let sound = Decoding::sound(all_contacts.iter().map(|it| it.decoded.missed));
        let is_stranger = |it: &&WrittenContact| {
            it.decoded.missed <= sound && mappings.iter().all(|(mapping, _)| mapping.contradicts(it))
        };
        let strangers = left.iter().filter(is_stranger).map(|it| it.row).collect();
        Some(Self { rows_late, all: all_contacts, wiring, mappings, strangers })
    }

    /// Whether most contacts agree with something.
    fn holds(&self) -> bool {
        let agreeing: usize = self.mappings.iter().map(|(_, rows)| rows.len()).sum();
        agreeing as f64 >= AGREEING * self.all.len() as f64
    }

    fn conventions(&self, pad: &SimulatedPad<'_>) -> Conventions {
        let readings = Readings::new(pad.device, pad.field);
        let symmetries = readings.symmetries(pad.device);
        let least = |mapping: &Mapping| {
            let convention = convention(mapping);
            let mistakes = |(symmetry, permutation): &(LabelConvention, SignedPermutation)| {
                let wiring = permutation.after(&self.wiring).mistakes();
                (mistakes(&before(&convention, symmetry)) + wiring, wiring)
            };
            symmetries.iter().min_by_key(|it| mistakes(it)).map(|(symmetry, _)| *symmetry)
        };
        // One pad has one wiring, whatever its labels are.
        let symmetry = self.mappings.first().and_then(|(mapping, _)| least(mapping)).unwrap_or_default();
        let mut conventions = Conventions {
            parts: Vec::new(),
            rows_late: self.rows_late,
            strangers: self.strangers.clone(),
            stuck: Vec::new(),
            contacts: self.all.len(),
        };
        for (mapping, rows) in &self.mappings {
            conventions.add(rows.clone(), before(&convention(mapping), &symmetry));
        }
        conventions
    }
}

/// Whether most of these contacts are followed by one of them.
fn follow_each_other(part: &[WrittenContact], all: &[WrittenContact]) -> bool {
    let is_of = |contact: &WrittenContact| part.binary_search_by_key(&contact.row, |it| it.row).is_ok();
    let following = all.windows(2).filter(|pair| is_of(&pair[0]) && is_of(&pair[1])).count();
    following as f64 >= FOLLOWING * part.len() as f64
}

impl Conventions {
    fn add(&mut self, rows: Vec<usize>, convention: LabelConvention) {
        if let Some(part) = self.parts.iter_mut().find(|part| part.convention == convention) {
            part.rows.extend(rows);
            return;
        }
        let Units { n, .. } = convention.units;
        // Forces in units of v newtons, or channels in units of 1/v microvolts.
        let by_channels = known(1.0 / n, CHANNEL_UNITS).filter(|_| n != 1.0);
        let mut part = LabelPart { rows, convention, is_channel_unit_open: false };
        if let Some(uv) = by_channels {
            part.is_channel_unit_open = known(n, FORCE_UNITS).is_some();
            part.convention.units = Units { n: 1.0, uv, ..convention.units };
        }
        self.parts.push(part);
    }
}

/// Contacts: the row that is read, its readings relative to those of the untouched pad, and its label, which stands so many rows later.
fn readings(table: &Table, rows_late: isize) -> Vec<(usize, [f64; CHANNELS], Label)> {
    let read = |labelled: usize| {
        let row = labelled.checked_add_signed(-rows_late)?;
        Some((row, table.rows.get(row)?.uv.as_ref()?))
    };
    let pressed = contacts(table);
    let step = pressed.len().div_ceil(CONTACTS_MAX).max(1);
    let untouched = UntouchedRows::of(table);
    let untouched: Vec<&[f64; CHANNELS]> = (0..table.rows.len())
        .filter(|at| untouched.is(&table.rows[*at]))
        .filter_map(|at| read(at).map(|(_, uv)| uv))
        .collect();
    // Some of them may be another row's.
    let zero: [f64; CHANNELS] =
        std::array::from_fn(|k| median(untouched.iter().map(|uv| uv[k])).unwrap_or_default());
    let relative = |at: usize| {
        let (row, uv) = read(at)?;
        let uv: [f64; CHANNELS] = std::array::from_fn(|k| uv[k] - zero[k]);
        uv.iter().all(|uv| uv.is_finite()).then_some((row, uv, table.rows[at].label))
    };
    // Nobody wrote the force of a known weight.
    let written = |at: &usize| table.rows[*at].weight_g.is_none();
    pressed.into_iter().filter(written).step_by(step).filter_map(relative).collect()
}

/// The convention by which labels follow contacts so.
fn convention(mapping: &Mapping) -> LabelConvention {
    let frame = told(mapping.place);
    let plane = in_steps(mapping.force.after(&frame.inverse()));
    let whole = |size: f64| {
        let digits = 10.0_f64.powi(1 - libm::floor(libm::log10(size)) as i32);
        libm::round(size * digits) / digits
    };
    let unit = |size: f64, none: f64, names| {
        if size > 1.0 / none && size < none { 1.0 } else { known(size, names).unwrap_or_else(|| whole(size)) }
    };
    LabelConvention {
        frame: Frame(frame),
        sign: Sign { plane, is_fz_reversed: mapping.is_fz_reversed },
        units: Units {
            mm: unit(mapping.unit_mm, PLACE_SIZE, PLACE_UNITS),
            n: unit(mapping.unit_n, FORCE_SIZE, FORCE_UNITS),
            uv: 1.0,
        },
    }
}

/// The size of the unit that is as large.
fn known(size: f64, names: &[(&str, f64)]) -> Option<f64> {
    let away = |known: f64| libm::log(size / known).abs();
    let nearest =
        names.iter().map(|(_, known)| *known).min_by(|one, other| away(*one).total_cmp(&away(*other)));
    nearest.filter(|known| away(*known) < libm::log(UNIT_WITHIN))
}

/// The map with an angle as people tell it.
fn told(map: PlaneMap) -> PlaneMap {
    let turn_deg = map.turn_deg();
    let step = TURN_STEP_DEG * libm::round(turn_deg / TURN_STEP_DEG);
    let is_step = (turn_deg - step).abs() < if step == 0.0 { TURN_MIN_DEG } else { TURN_NEAR_DEG };
    PlaneMap::new(if is_step { step } else { libm::round(turn_deg) }, map.is_mirrored())
}

/// The same of forces, whose directions are known less well.
fn in_steps(map: PlaneMap) -> PlaneMap {
    PlaneMap::new(TURN_STEP_DEG * libm::round(map.turn_deg() / TURN_STEP_DEG), map.is_mirrored())
}

/// The convention by which labels of contacts that a symmetry has changed are meant as those of the others are.
fn before(convention: &LabelConvention, symmetry: &LabelConvention) -> LabelConvention {
    // Written by M of c, and c' is what the symmetry means by c, so by M g of c'; the same of forces with S M.
    let frame = told(convention.frame.0.after(&symmetry.frame.0));
    let force = convention.sign.plane.after(&convention.frame.0);
    let force = force.after(&symmetry.sign.plane.after(&symmetry.frame.0));
    LabelConvention {
        frame: Frame(frame),
        sign: Sign {
            plane: in_steps(force.after(&frame.inverse())),
            is_fz_reversed: convention.sign.is_fz_reversed != symmetry.sign.is_fz_reversed,
        },
        units: convention.units,
    }
}

/// How many mistakes a convention takes: one for the frame, one for the signs.
fn mistakes(convention: &LabelConvention) -> usize {
    usize::from(convention.frame != Frame::default()) + usize::from(convention.sign != Sign::default())
}
