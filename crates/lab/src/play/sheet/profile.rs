//! What a profile does, on one page: the plate with its directions and zones, what each press does, how it fits the hand, and the date.

use super::Sheet;
use super::mark::A4_AND_LETTER_MM;
use tactpad_core::pipeline::mapping::plain::summary::{Part, Reader, Summary};
use tactpad_core::pipeline::mapping::profile::Profile;
use tactpad_core::pipeline::mapping::profile::sketch::{
    ButtonForces, DpadSketch, PLATE_MM, Sketch, ZoneSketch, polar,
};

/// Where the plate's centre lies, and how much larger than itself it is.
const CENTRE_MM: [f64; 2] = [64.0, 86.0];
const SCALE: f64 = 1.3;
/// Edges of what is written.
const LEFT_MM: f64 = 18.0;
const RIGHT_MM: f64 = 192.0;
const BOTTOM_MM: f64 = 268.0;
/// What fits the hand stands beside the plate, from here on,
const HAND_MM: [f64; 2] = [116.0, 50.0];
/// and what presses do below it.
const DOES_TOP_MM: f64 = 146.0;
/// A push is an arrow from here on, outside of the plate,
const PUSH_MM: f64 = PLATE_MM as f64 + 1.0;
/// so long, with barbs so long and its number so far beside it.
const ARROW_MM: f64 = 4.0;
const BARB_MM: f64 = 1.2;
const BESIDE_MM: f64 = 2.6;
/// The numbers of what is pressed anywhere stand so far above the middle.
const ABOVE_MM: f32 = 4.0;
/// Strokes.
const THIN_MM: f64 = 0.15;
const MIDDLE_MM: f64 = 0.3;
const THICK_MM: f64 = 0.6;
/// Heights of letters.
const TITLE_MM: f64 = 9.0;
const HEAD_MM: f64 = 4.6;
const TEXT_MM: f64 = 3.4;
const PLATE_TEXT_MM: f64 = 3.6;
/// Width of a letter over its height, on average over a line.
const LETTER: f64 = 0.5;
/// From one line to the next, over the height of its letters.
const LINE: f64 = 1.35;
/// An arc is drawn as lines of so many degrees.
const ARC_DEG: f32 = 3.0;

impl Sheet {
    /// What a profile does, with the date on which that is so.
    pub fn of_profile(profile: &Profile, date: &str) -> Self {
        let (sketch, summary) = (Sketch::of(profile), Summary::of(profile, Reader::Player));
        let mut sheet =
            Self { page_mm: A4_AND_LETTER_MM, centre_mm: CENTRE_MM, scale: SCALE, marks: Vec::new() };
        sheet.head(&summary, date);
        sheet.plate(&sketch);
        sheet.hand(&summary);
        sheet.does(&summary.does);
        sheet
    }

    fn head(&mut self, summary: &Summary, date: &str) {
        let title = wrapped(&summary.name, RIGHT_MM - LEFT_MM, TITLE_MM).swap_remove(0);
        self.text([LEFT_MM, 25.0], TITLE_MM, &title);
        self.text([LEFT_MM, 32.0], TEXT_MM, &format!("tactpad, played on the {}; {date}", summary.output));
        self.rule(36.0, THICK_MM);
    }

    /// A line across the page.
    fn rule(&mut self, y_mm: f64, width_mm: f64) {
        let plate = |x_mm: f64| [(x_mm - CENTRE_MM[0]) / SCALE, (CENTRE_MM[1] - y_mm) / SCALE];
        self.line(plate(LEFT_MM), plate(RIGHT_MM), width_mm);
    }

    fn plate(&mut self, sketch: &Sketch) {
        let centre = sketch.centre_mm;
        self.circle([0.0; 2], PLATE_MM.into(), THICK_MM);
        sketch.dpad.iter().for_each(|dpad| self.directions(centre, dpad, &sketch.buttons));
        sketch.zones.iter().for_each(|zone| self.zone(centre, zone, &sketch.buttons));
        self.buttons(sketch);
        let pointer = sketch.pointer.iter().map(|it| (it.full_radius_mm, "pointer", it.word_at_mm));
        let sticks = sketch.sticks.iter().filter(|stick| stick.from == "place");
        let sticks = sticks.map(|stick| (stick.full, stick.word.as_str(), stick.word_at_mm));
        for (radius_mm, word, at_mm) in pointer.chain(sticks) {
            self.arc(centre, [0.0, 360.0], radius_mm, THIN_MM);
            self.word(at_mm, word);
        }
        let [x_mm, y_mm] = centre.map(f64::from);
        self.line([x_mm - 1.0, y_mm], [x_mm + 1.0, y_mm], MIDDLE_MM);
        self.line([x_mm, y_mm - 1.0], [x_mm, y_mm + 1.0], MIDDLE_MM);
    }

    /// What counts on the whole plate: pushes as arrows, presses above the middle, each with its number.
    fn buttons(&mut self, sketch: &Sketch) {
        let anywhere: Vec<_> = sketch.buttons.iter().filter(|it| it.zone.is_none()).collect();
        let numbers = |force: &str| numbers(anywhere.iter().filter(|it| it.force == force));
        let [x_mm, y_mm] = sketch.centre_mm;
        self.word([x_mm, y_mm + ABOVE_MM], &numbers("fz"));
        for (force, [x, y]) in
            [("fy", [0.0, 1.0]), ("-fy", [0.0, -1.0]), ("fx", [1.0, 0.0]), ("-fx", [-1.0, 0.0])]
        {
            let numbers = numbers(force);
            if numbers.is_empty() {
                continue;
            }
            let at = |out_mm: f64, side_mm: f64| [x * out_mm - y * side_mm, y * out_mm + x * side_mm];
            let tip_mm = PUSH_MM + ARROW_MM;
            self.line(at(PUSH_MM, 0.0), at(tip_mm, 0.0), THICK_MM);
            for side_mm in [-BARB_MM, BARB_MM] {
                self.line(at(tip_mm - BARB_MM, side_mm), at(tip_mm, 0.0), THICK_MM);
            }
            self.word(at(PUSH_MM + 0.5 * ARROW_MM, BESIDE_MM).map(|mm| mm as f32), &numbers);
        }
    }

    fn directions(&mut self, centre: [f32; 2], dpad: &DpadSketch, buttons: &[ButtonForces]) {
        self.arc(centre, [0.0, 360.0], dpad.centre_radius_mm, MIDDLE_MM);
        for sector in &dpad.sectors {
            self.ray(centre, sector.from_deg, [dpad.centre_radius_mm, f32::INFINITY], MIDDLE_MM);
            // What holds two directions, or keeps the last, is told by its neighbours.
            if sector.directions.len() == 1 {
                self.word(sector.word_at_mm, &numbered(&sector.word, sector.directions[0], buttons));
            }
        }
    }

    fn zone(&mut self, centre: [f32; 2], zone: &ZoneSketch, buttons: &[ButtonForces]) {
        let radii_mm = [zone.inner_radius_mm, zone.outer_radius_mm];
        let edges = zone.from_deg.zip(zone.to_deg);
        let (from_deg, to_deg) = edges.unwrap_or((0.0, 360.0));
        radii_mm.iter().for_each(|radius_mm| self.arc(centre, [from_deg, to_deg], *radius_mm, MIDDLE_MM));
        if let Some((from_deg, to_deg)) = edges {
            [from_deg, to_deg].iter().for_each(|deg| self.ray(centre, *deg, radii_mm, MIDDLE_MM));
        }
        self.word(zone.name_at_mm, &numbered(&zone.name, &zone.name, buttons));
    }

    /// A part of a ring, counter-clockwise; no farther out than the rim.
    fn arc(&mut self, centre: [f32; 2], [from_deg, to_deg]: [f32; 2], radius_mm: f32, width_mm: f64) {
        if radius_mm <= 0.0 {
            return;
        }
        let steps = ((to_deg - from_deg) / ARC_DEG).ceil().max(1.0) as usize;
        let at = |step: usize| from_deg + (to_deg - from_deg) * step as f32 / steps as f32;
        for step in 0..steps {
            let ends = [at(step), at(step + 1)];
            if ends.iter().all(|deg| radius_mm < rim_mm(centre, *deg)) {
                let [from, to] = ends.map(|deg| polar(centre, deg, radius_mm).map(f64::from));
                self.line(from, to, width_mm);
            }
        }
    }

    /// A line outwards; no farther than the rim.
    fn ray(&mut self, centre: [f32; 2], deg: f32, [from_mm, to_mm]: [f32; 2], width_mm: f64) {
        let rim_mm = rim_mm(centre, deg);
        if from_mm < rim_mm {
            let [from, to] = [from_mm, to_mm.min(rim_mm)].map(|mm| polar(centre, deg, mm).map(f64::from));
            self.line(from, to, width_mm);
        }
    }

    /// A word around a place of the plate.
    fn word(&mut self, at_mm: [f32; 2], word: &str) {
        let [x_mm, y_mm] = self.on_page(at_mm.map(f64::from));
        let lines: Vec<&str> = word.split(": ").collect();
        for (line, text) in lines.iter().enumerate() {
            let down_mm = (line as f64 - 0.5 * (lines.len() as f64 - 1.0)) * 1.2 * PLATE_TEXT_MM;
            let at_mm = [x_mm - 0.5 * width_mm(text, PLATE_TEXT_MM), y_mm + 0.35 * PLATE_TEXT_MM + down_mm];
            self.text(at_mm, PLATE_TEXT_MM, text);
        }
    }

    fn hand(&mut self, summary: &Summary) {
        let [x_mm, mut y_mm] = HAND_MM;
        if summary.hand.is_empty() {
            return;
        }
        self.text([x_mm, y_mm], HEAD_MM, "How it fits the hand");
        for (word, value) in &summary.hand {
            for line in wrapped(&format!("{word}: {value}"), RIGHT_MM - x_mm, TEXT_MM) {
                y_mm += 1.6 * TEXT_MM;
                self.text([x_mm, y_mm], TEXT_MM, &line);
            }
        }
    }

    fn does(&mut self, does: &[Part]) {
        self.rule(DOES_TOP_MM - 10.0, THICK_MM);
        self.text([LEFT_MM, DOES_TOP_MM - 3.0], HEAD_MM, "What each press does");
        let newton = "N is force: what 100 g weigh is about 1 N";
        self.text([RIGHT_MM - width_mm(newton, TEXT_MM), DOES_TOP_MM - 3.0], TEXT_MM, newton);
        let layout = Layout::of(does);
        let lines: Vec<PartLines> = does.iter().map(|part| layout.lines(part)).collect();
        let room_mm = layout.room_mm(&lines);
        let (mut column, mut y_mm) = (0, DOES_TOP_MM);
        for part in &lines {
            let height_mm = layout.height_mm(part);
            if y_mm + height_mm > DOES_TOP_MM + room_mm && column + 1 < layout.columns {
                (column, y_mm) = (column + 1, DOES_TOP_MM);
            }
            self.part([LEFT_MM + column as f64 * layout.column_mm(), y_mm], layout, part);
            y_mm += height_mm;
        }
    }

    /// What comes of a press, large; below it what the hand does, and with which numbers.
    fn part(&mut self, [x_mm, mut y_mm]: [f64; 2], layout: Layout, part: &PartLines) {
        let [head_mm, text_mm] = layout.sizes_mm();
        for (lines, size_mm) in [(&part.gives, head_mm), (&part.below, text_mm)] {
            for line in lines {
                y_mm += LINE * size_mm;
                self.text([x_mm, y_mm], size_mm, line);
            }
        }
    }
}

/// How what presses do is laid out: in so many columns, with letters so much larger than usual.
#[derive(Clone, Copy)]
struct Layout {
    columns: usize,
    share: f64,
}

/// A part in lines.
struct PartLines {
    gives: Vec<String>,
    below: Vec<String>,
}

impl Layout {
    /// The one with the largest letters that has room, one column before two.
    fn of(does: &[Part]) -> Self {
        let shares = |columns, most: usize, least| {
            (least..=most).rev().map(move |tenths| Self { columns, share: tenths as f64 / 10.0 })
        };
        let all = shares(1, 15, 9).chain(shares(2, 11, 3)).chain([Self { columns: 2, share: 0.2 }]);
        let has_room = |layout: &Self| {
            let lines: Vec<_> = does.iter().map(|part| layout.lines(part)).collect();
            layout.room_mm(&lines) <= BOTTOM_MM - DOES_TOP_MM
        };
        all.clone().find(has_room).or_else(|| all.last()).unwrap_or(Self { columns: 2, share: 0.2 })
    }

    fn sizes_mm(self) -> [f64; 2] {
        [HEAD_MM, TEXT_MM].map(|size_mm| self.share * size_mm)
    }

    fn column_mm(self) -> f64 {
        (RIGHT_MM - LEFT_MM) / self.columns as f64
    }

    fn lines(self, Part { button, hand, gives, numbers }: &Part) -> PartLines {
        let (width_mm, [head_mm, text_mm]) = (self.column_mm() - 4.0, self.sizes_mm());
        let below = if numbers.is_empty() { hand.clone() } else { format!("{hand}; {numbers}") };
        let gives = button.map_or_else(|| gives.clone(), |number| format!("{number}. {gives}"));
        PartLines { gives: wrapped(&gives, width_mm, head_mm), below: wrapped(&below, width_mm, text_mm) }
    }

    fn height_mm(self, part: &PartLines) -> f64 {
        let [head_mm, text_mm] = self.sizes_mm();
        LINE * (head_mm * part.gives.len() as f64 + text_mm * (part.below.len() as f64 + 1.0))
    }

    /// The height of the highest column.
    fn room_mm(self, parts: &[PartLines]) -> f64 {
        let heights_mm = parts.iter().map(|part| self.height_mm(part));
        let highest_mm = heights_mm.clone().fold(0.0, f64::max);
        let all_mm: f64 = heights_mm.sum();
        if self.columns == 1 { all_mm } else { 0.5 * (all_mm + highest_mm) }
    }
}

/// Their numbers, as the list below the plate has them.
fn numbers<'a>(buttons: impl Iterator<Item = &'a &'a ButtonForces>) -> String {
    buttons.map(|it| it.number.to_string()).collect::<Vec<_>>().join(", ")
}

/// The word of a part of the plate, and in a line of their own the numbers of the buttons that count there.
fn numbered(word: &str, part: &str, buttons: &[ButtonForces]) -> String {
    let here: Vec<_> = buttons.iter().filter(|it| it.zone.as_deref() == Some(part)).collect();
    if here.is_empty() { word.to_owned() } else { format!("{word}: {}", numbers(here.iter())) }
}

/// How far the plate's rim is from a place, in a direction.
fn rim_mm([x_mm, y_mm]: [f32; 2], deg: f32) -> f32 {
    let [cos, sin] = polar([0.0; 2], deg, 1.0);
    let along_mm = x_mm * cos + y_mm * sin;
    let beside_sq = x_mm * x_mm + y_mm * y_mm - along_mm * along_mm;
    (PLATE_MM * PLATE_MM - beside_sq).max(0.0).sqrt() - along_mm
}

fn width_mm(text: &str, size_mm: f64) -> f64 {
    LETTER * size_mm * text.chars().count() as f64
}

/// The words of a text in lines that have room; at least one. A word that is longer than a line is cut.
fn wrapped(text: &str, room_mm: f64, size_mm: f64) -> Vec<String> {
    let most = (room_mm / (LETTER * size_mm)).max(1.0) as usize;
    let mut lines = vec![String::new()];
    for word in inseparable(text) {
        let word: String = word.chars().take(most).collect();
        match lines.last_mut() {
            Some(line) if line.is_empty() => *line = word,
            Some(line) if line.chars().count() + 1 + word.chars().count() <= most => {
                *line += &format!(" {word}");
            }
            _ => lines.push(word),
        }
    }
    lines
}

/// The words of a text; a number and its unit are one.
fn inseparable(text: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match words.last_mut() {
            Some(last) if last.parse::<f64>().is_ok() => *last += &format!(" {word}"),
            _ => words.push(word.to_owned()),
        }
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::play::sheet::mark::Mark;
    use tactpad_core::pipeline::mapping::read::check::{OutputChoice, read};
    use tactpad_core::pipeline::mapping::read::shipped;

    fn sheet(text: &str) -> Sheet {
        let (profile, found) = read(text, OutputChoice::AsWritten);
        Sheet::of_profile(&profile.unwrap_or_else(|| panic!("{found:?}")), "2026-11-28")
    }

    /// As many buttons as there can be, each with three kinds of press, and every setting of the hand.
    fn fullest() -> String {
        let binding =
            "{ gamepad = \"BTN_SOUTH\", keyboard = \"KEY_Z\", label = \"jump over the (high) wall\" }";
        let button = format!(
            "[[button]]\nforce = \"fz\"\npress_n = 2\ntap = {binding}\ndouble = {binding}\nhold = {binding}\n"
        );
        format!(
            "schema = 1\nname = \"Ünïcode\"\noutput = \"gamepad\"\ncentre_x_mm = 10\ncentre_y_mm = 5\n\
             access = {{ slow_ms = 10, bounce_ms = 10, tremor_hz = 1, rest_n = 1 }}\n\
             gain = {{ up = 2, down = 2, left = 2, right = 2 }}\n[dpad]\nlabel = {{ up = \"climb\" }}\n\
             [[zone]]\nname = \"top\"\nfrom_deg = 45\nto_deg = 135\ninner_radius_mm = 10\n{}",
            button.repeat(16)
        )
    }

    #[test]
    fn all_of_it_lies_on_the_page() {
        let texts = shipped::names().filter_map(shipped::text).map(str::to_owned).chain([fullest()]);
        for mark in texts.flat_map(|text| sheet(&text).marks) {
            let inside =
                |[x_mm, y_mm]: [f64; 2]| (10.0..=200.0).contains(&x_mm) && (10.0..=272.0).contains(&y_mm);
            match mark {
                Mark::Line { from_mm, to_mm, .. } => assert!(inside(from_mm) && inside(to_mm), "{from_mm:?}"),
                Mark::Circle { centre_mm, .. } => assert!(inside(centre_mm)),
                Mark::Text { at_mm: [x_mm, y_mm], size_mm, text } => {
                    let end_mm = x_mm + width_mm(&text, size_mm);
                    assert!(inside([x_mm, y_mm]) && inside([end_mm, y_mm]), "{text}: {x_mm} {y_mm} {end_mm}");
                }
            }
        }
    }

    #[test]
    fn it_says_what_presses_do_in_all_three_forms() {
        let contra = sheet(shipped::text("contra").unwrap());
        for words in ["Contra", "A: jump", "press into the plate; press force 2 N", "2026-11-28"] {
            assert!(contra.svg().contains(words) && contra.html("a < b").contains(words), "{words}");
            let pdf = String::from_utf8(contra.pdf()).unwrap();
            assert!(pdf.contains(words), "{words}");
        }
        assert!(!contra.svg().contains("samples") && !contra.svg().contains("let-go"));
        assert!(contra.html("a < b").contains("<title>a &lt; b</title>"));
        let full = sheet(&fullest());
        assert!(String::from_utf8(full.pdf()).unwrap().contains("(\\334n\\357code)"));
        assert!(full.svg().contains("climb") && full.svg().contains("Ünïcode"));
    }
}
