//! What is said of the labels: findings, what tells them from faults of the wiring, and the arguments that mend them.

use super::detection::{Conventions, LabelPart};
use super::stuck::StuckLabel;
use super::symmetry::Readings;
use crate::diagnosis::data::target::{LabelColumns, Target};
use crate::diagnosis::report::{Estimate, Finding, LabelNote, Notice};
use crate::effect::Effect;
use crate::tangent::SimulatedPad;
use tactpad_core::counted::counted;
use tactpad_core::pad::wiring::permutation::SignedPermutation;
use tactpad_core::quantity::{CHANNEL_NAMES, CHANNELS};
use tactpad_core::tables::convention::{Frame, LabelConvention, Sign};
use tactpad_core::tables::measured::{Label, Table};
use tactpad_core::tables::units::Units;

/// A contact agrees with a convention by chance in no more than this share: the places of a tolerance on a plate.
const BY_CHANCE: f64 = 0.03;
/// A press that tells wiring from labels lies so far from the middle.
const PRESS_MM: f64 = 15.0;
const PRESS_N: f64 = 2.0;
/// Hours of a clock's face, three o'clock being +x.
const HOURS: [i32; 12] = [3, 12, 9, 6, 1, 2, 4, 5, 7, 8, 10, 11];

impl Conventions {
    /// What is not as it should be, but for effects that are not asked for. `share` is the part of the squared residual that it is.
    pub(crate) fn findings(&self, table: &Table, pad: &SimulatedPad<'_>, share: f64) -> Vec<Finding> {
        let readings = Readings::new(pad.device, pad.field);
        let mut found: Vec<Finding> = self.row_shift().into_iter().collect();
        found.extend(self.stuck.iter().map(|stuck| self.stuck_label(stuck, table)));
        for part in &self.parts {
            let of_part = self.part_text(part, table);
            let part = PartFindings { part, text: of_part.as_ref(), readings: &readings };
            found.extend(part.frame().into_iter().chain(part.sign()).chain(part.units()));
        }
        let each = share / found.len().max(1) as f64;
        found.into_iter().map(|finding| Finding { share: each, ..finding }).collect()
    }

    /// Rows that were left out.
    pub(crate) fn notice(&self, table: &Table) -> Option<Notice> {
        let lines: Vec<usize> = self.strangers.iter().map(|row| table.rows[*row].line).collect();
        let (first, last) = (lines.iter().min()?, lines.iter().max()?);
        let detail = format!(
            "{} between lines {first} and {last} read one finger, but on another place or with another force than written; they are left \
             out; see whether they are of this recording, and in its order",
            counted(lines.len(), "row")
        );
        Some(Notice { check: "labels", channel: None, detail })
    }

    fn stuck_label(&self, stuck: &StuckLabel, table: &Table) -> Finding {
        let rows = stuck.rows.len() as f64;
        let part = self.rows_text(&stuck.rows, table);
        let note = LabelNote { map: None, part, argument: None };
        let parameters = vec![Estimate { name: "rows", value: rows, interval95: [rows; 2] }];
        finding(Effect::LabelStuck, LabelColumns::One(stuck.column), stuck.rows.len(), note)
            .with_parameters(parameters)
    }

    fn row_shift(&self) -> Option<Finding> {
        let rows = self.rows_late as f64;
        let parameters = vec![Estimate { name: "rows", value: rows, interval95: [rows; 2] }];
        let contacts: usize = self.parts.iter().map(|part| part.rows.len()).sum();
        let note = LabelNote { map: None, part: None, argument: None };
        (self.rows_late != 0)
            .then(|| finding(Effect::RowShift, LabelColumns::All, contacts, note).with_parameters(parameters))
    }

    /// The part's rows, where they are not all.
    fn part_text(&self, part: &LabelPart, table: &Table) -> Option<String> {
        self.rows_text(&part.rows, table).filter(|_| self.parts.len() > 1)
    }

    fn rows_text(&self, rows: &[usize], table: &Table) -> Option<String> {
        let line = |row: &usize| table.rows[*row].line;
        let [first, last] = [rows.iter().map(line).min()?, rows.iter().map(line).max()?];
        Some(format!("{} of {} contacts, lines {first} to {last}", rows.len(), self.contacts))
    }
}

fn finding(effect: Effect, columns: LabelColumns, contacts: usize, note: LabelNote) -> Finding {
    Finding {
        effect,
        target: Target::Labels(columns),
        parameters: Vec::new(),
        shapes: Vec::new(),
        p_value: BY_CHANCE.powi(contacts as i32).max(f64::MIN_POSITIVE),
        share: 0.0,
        confounded_with: Vec::new(),
        separate_by: None,
        labels: Some(note),
    }
}

impl Finding {
    fn with_parameters(self, parameters: Vec<Estimate>) -> Self {
        Self { parameters, ..self }
    }
}

/// The findings of a part of the labels.
struct PartFindings<'c> {
    part: &'c LabelPart,
    text: Option<&'c String>,
    readings: &'c Readings<'c>,
}

impl PartFindings<'_> {
    fn finding(
        &self,
        effect: Effect,
        columns: LabelColumns,
        map: Option<String>,
        argument: String,
    ) -> Finding {
        let argument = Some(argument).filter(|_| self.text.is_none());
        let note = LabelNote { map, part: self.text.cloned(), argument };
        finding(effect, columns, self.part.rows.len(), note)
    }

    fn frame(&self) -> Option<Finding> {
        let Frame(frame) = self.part.convention.frame;
        let own = LabelConvention { frame: Frame(frame), ..LabelConvention::default() };
        let text = Frame(frame).to_string();
        let argument = format!("--frame \"{text}\"");
        let found = || self.finding(Effect::LabelFrame, LabelColumns::All, Some(text), argument);
        (!own.is_default()).then(|| self.beside_wiring(found(), &own))
    }

    fn sign(&self) -> Option<Finding> {
        let LabelConvention { frame, sign, .. } = self.part.convention;
        let own = LabelConvention { sign, ..LabelConvention::default() };
        let text = sign.to_string();
        let argument = format!("--sign \"{text}\"");
        let found = || self.finding(Effect::LabelSign, LabelColumns::Forces, Some(text), argument);
        if own.is_default() {
            return None;
        }
        // The forces' map in the pad's frame: M⁻¹ S M.
        let plane = frame.0.inverse().after(&sign.plane).after(&frame.0);
        let in_frame = LabelConvention { sign: Sign { plane, ..sign }, ..LabelConvention::default() };
        Some(self.beside_wiring(found(), &in_frame))
    }

    fn units(&self) -> Vec<Finding> {
        let Units { mm, n, uv } = self.part.convention.units;
        let argument = || format!("--units \"{}\"", self.part.convention.units);
        let unit = |columns: LabelColumns, size: f64| {
            let parameters = vec![Estimate { name: "factor", value: size, interval95: [size; 2] }];
            let found = self.finding(Effect::LabelUnit, columns, None, argument());
            (size != 1.0).then(|| found.with_parameters(parameters))
        };
        let mut channels = unit(LabelColumns::Channels, uv);
        if let Some(channels) = channels.as_mut().filter(|_| self.part.is_channel_unit_open) {
            channels.confounded_with = vec![(Effect::LabelUnit, Target::Labels(LabelColumns::Forces))];
            channels.separate_by = Some(
                "lay a known weight on the plate: the force's column says it in newtons, or not; else the channels' unit is another"
                    .to_owned(),
            );
        }
        let all = [unit(LabelColumns::Places, mm), unit(LabelColumns::Forces, n), channels];
        all.into_iter().flatten().collect()
    }

    /// With the faults of the wiring that would read the same.
    fn beside_wiring(&self, finding: Finding, convention: &LabelConvention) -> Finding {
        let Some(permutation) = self.readings.permutation(convention) else { return finding };
        let exchanged = permutation
            .exchanged()
            .into_iter()
            .map(|[into, from]| (Effect::ChannelsSwapped, Target::Channels { into, from }));
        let reversed =
            permutation.reversed().into_iter().map(|k| (Effect::ChannelPolarity, Target::Channel(k)));
        Finding {
            confounded_with: exchanged.chain(reversed).collect(),
            separate_by: self.separating_press(&permutation),
            ..finding
        }
    }

    /// The press that answers otherwise if the labels are meant otherwise than if the wiring is wrong.
    fn separating_press(&self, permutation: &SignedPermutation) -> Option<String> {
        let answers = |hour: i32| {
            let angle = f64::from(90 - 30 * hour).to_radians();
            let [x_mm, y_mm] = [PRESS_MM * libm::cos(angle), PRESS_MM * libm::sin(angle)];
            let by_labels = self.readings.of(&Label { x_mm, y_mm, fz_n: PRESS_N, ..Label::default() });
            (by_labels, permutation.of(&by_labels))
        };
        let by_module = |hour: i32| {
            let (labels, wiring) = answers(hour);
            let [labels, wiring] = [strongest_module(&labels), strongest_module(&wiring)];
            (labels != wiring).then(|| {
                format!(
                    "press at {hour} o'clock, {PRESS_MM} mm from the middle: if module {labels} answers most, the labels are meant otherwise; \
                     if module {wiring} does, the wiring is wrong"
                )
            })
        };
        let by_sign = |hour: i32| {
            let (labels, wiring) = answers(hour);
            let channel = strongest(&labels);
            (labels[channel] * wiring[channel] < 0.0).then(|| {
                let [one, other] =
                    if labels[channel] > 0.0 { ["rises", "falls"] } else { ["falls", "rises"] };
                format!(
                    "press down at {hour} o'clock, {PRESS_MM} mm from the middle: if {} {one}, the labels are meant otherwise; if it {other}, \
                     the wiring is wrong",
                    CHANNEL_NAMES[channel]
                )
            })
        };
        HOURS.into_iter().find_map(by_module).or_else(|| HOURS.into_iter().find_map(by_sign))
    }
}

fn strongest(readings: &[f64; CHANNELS]) -> usize {
    let largest = |one: &usize, other: &usize| readings[*one].abs().total_cmp(&readings[*other].abs());
    (0..CHANNELS).max_by(largest).unwrap_or_default()
}

fn strongest_module(readings: &[f64; CHANNELS]) -> usize {
    let square = |module: usize| readings[3 * module..][..3].iter().map(|uv| uv * uv).sum::<f64>();
    (0..CHANNELS / 3).max_by(|one, other| square(*one).total_cmp(&square(*other))).unwrap_or_default()
}

/// Why a decoder is not fitted to a table whose labels are meant otherwise; `None` where they are as they should be.
pub fn refusal(table: &Table, pad: &SimulatedPad<'_>) -> Option<String> {
    let conventions = Conventions::of(table, pad);
    let findings = conventions.findings(table, pad, 0.0);
    if conventions.are_meant_so() && conventions.stuck.is_empty() {
        return None;
    }
    let said: Vec<String> = findings.iter().map(sentence).collect();
    let arguments: Vec<String> =
        conventions.parts.first().map(|part| part.convention.to_string()).into_iter().collect();
    let way_out =
        if !conventions.stuck.is_empty() || conventions.parts.len() > 1 || conventions.rows_late != 0 {
            "mend these columns, and give the table again".to_owned()
        } else {
            format!("say so with {}, or mend the table", arguments.concat())
        };
    let otherwise = findings.iter().find_map(|it| it.separate_by.as_ref());
    let otherwise = otherwise.map(|press| format!("; to be sure {press}")).unwrap_or_default();
    Some(format!(
        "{}; {way_out}; if the labels are right as they are, give --frame \"x,y\"{otherwise}",
        said.join("; ")
    ))
}

fn sentence(finding: &Finding) -> String {
    let note = finding.labels.as_ref();
    let part = note.and_then(|it| it.part.as_ref()).map(|part| format!(" in {part}")).unwrap_or_default();
    let map = note.and_then(|it| it.map.as_deref()).unwrap_or_default();
    let value = finding.parameters.first().map_or(1.0, |it| it.value);
    let columns = match finding.target {
        Target::Labels(columns) => columns.name(),
        _ => "",
    };
    match finding.effect {
        Effect::LabelFrame => format!("the labels stand in another frame than the pad's, \"{map}\"{part}"),
        Effect::LabelSign => format!("the forces' signs are not the finger's, \"{map}\"{part}"),
        Effect::LabelStuck => {
            format!("{columns} stands still{part}, while the contacts that the channels tell go on")
        }
        Effect::RowShift if value > 0.0 => format!("the labels are {value} rows late"),
        Effect::RowShift => format!("the labels are {} rows early", -value),
        _ => format!("the unit of {columns} is another, {value} of the one that is expected{part}"),
    }
}
