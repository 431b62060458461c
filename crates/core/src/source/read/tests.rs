//! Descriptions, right and wrong.

use super::measures::{CELL_KEYS, CONTACT_KEYS, WRENCH_KEYS};
use super::origin::{EVDEV_KEYS, LINES_KEYS, REPORTS};
use super::reach::{AREA_KEYS, FORCE_KEYS};
use super::*;
use crate::source::codes::{self, CODES};
use crate::source::{Lines, Origin, Reports, shipped};
use crate::toml_text::diag::Severity;

const CELLS: &str = "schema = 1\nname = \"board\"\ntitle = \"A board\"\n[lines]\n[area]\nhalf_width_mm = 60\n\
    half_height_mm = 60\n[force]\nunit = \"N\"\nfull_n = 50.0\n[[cell]]\nx_mm = -60\ny_mm = 60\n[[cell]]\nx_mm = 60\n\
    y_mm = 60\n[[cell]]\nx_mm = 0\ny_mm = -60\n";

fn messages(text: &str) -> Vec<String> {
    read(text).1.into_iter().map(|found| format!("{}: {}", found.line, found.message)).collect()
}

#[test]
fn what_is_shipped_is_in_order_and_named_like_its_file() {
    for name in shipped::names() {
        let text = shipped::text(name).unwrap();
        let (source, found) = read(text);
        assert_eq!(found, [], "{name}");
        let source = source.unwrap();
        assert_eq!(source.name, name);
        assert!(
            source.decoder().is_some() && is_meant(text) && text.starts_with(shipped::SCHEMA_LINE),
            "{name}"
        );
    }
}

#[test]
fn the_schema_and_the_reader_know_the_same_keys_and_words() {
    let schema: serde_json::Value = serde_json::from_str(shipped::schema()).unwrap();
    let sorted = |mut words: Vec<String>| {
        words.sort();
        words
    };
    let keys = |table: &serde_json::Value| {
        sorted(table["properties"].as_object().unwrap().keys().cloned().collect())
    };
    let read = |words: &[&str]| sorted(words.iter().map(|word| (*word).to_owned()).collect());
    assert_eq!(keys(&schema), read(&ROOT_KEYS));
    let tables: [(&str, &[&str]); 7] = [
        ("lines", &LINES_KEYS),
        ("evdev", &EVDEV_KEYS),
        ("area", &AREA_KEYS),
        ("force", &FORCE_KEYS),
        ("cell", &CELL_KEYS),
        ("wrench", &WRENCH_KEYS),
        ("contact", &CONTACT_KEYS),
    ];
    for (name, known) in tables {
        assert_eq!(keys(&schema["$defs"][name]), read(known), "{name}");
    }
    let listed = |name: &str| {
        let words = schema["$defs"][name]["enum"].as_array().unwrap().iter();
        sorted(words.map(|word| word.as_str().unwrap().to_owned()).collect())
    };
    assert_eq!(listed("axis"), read(&codes::AXES.map(|(name, _)| name)));
    assert_eq!(listed("code"), read(&CODES.map(|(name, _)| name)));
    assert_eq!(listed("reports"), read(&REPORTS.map(|(name, _)| name)));
}

#[test]
fn the_least_description_has_all_else_by_default() {
    let source = read(CELLS).0.unwrap();
    let lines = Lines { baud: 115_200, columns: vec![1, 2, 3], decimals: 2 };
    assert_eq!(source.origin, Origin::Lines(lines));
    assert_eq!(source.channel_names(), ["cell 1", "cell 2", "cell 3"]);
    assert!(!source.has_shear());
}

#[test]
fn each_mistake_has_its_line_and_all_are_told() {
    for (from, to, line, message) in [
        ("schema = 1", "schema = 2", 1, "\"schema\" is 2; it must be 1"),
        ("\"board\"", "\"My board\"", 2, "\"name\" must be 1 to 32 small letters, digits and -"),
        ("title", "tilte", 3, "unknown key \"tilte\" in the description"),
        ("[lines]", "[lines]\nbaud = 12", 5, "\"baud\" is 12; it must be 300 to 4000000"),
        ("[lines]", "[lines]\ncolumns = [1, 2]", 5, "\"columns\" must be a list of 3 numbers, not of 2"),
        ("[lines]", "[lines]\ncolumns = [1, 2, 2]", 5, "\"columns\" has a number twice"),
        ("[lines]", "[lines]\ncolumns = [0, 2, 3]", 5, "\"columns\" are counted from 1 to 32"),
        ("half_width_mm = 60", "half_width_mm = 0", 6, "\"half_width_mm\" is 0; it must be 5 to 1000"),
        ("unit = \"N\"", "unit = \"count\"", 8, "[force] lacks \"n_per_count\""),
        ("unit = \"N\"", "unit = \"stone\"", 9, "\"unit\" cannot be \"stone\""),
        ("full_n = 50.0", "", 8, "[force] lacks \"full_n\""),
        ("y_mm = -60", "y_mm = 60", 11, "the cells stand in one line: no place across it can be told"),
        ("x_mm = 0", "x = 0", 17, "cell 3 lacks \"x_mm\""),
    ] {
        let text = CELLS.replacen(from, to, 1);
        let found = messages(&text);
        assert!(found.contains(&format!("{line}: {message}")), "{to}: {found:?}");
        assert!(read(&text).0.is_none());
    }
    assert!(messages("").len() >= 5, "{:?}", messages(""));
    let both = format!("{CELLS}[wrench]\nmoment_unit = \"Nm\"\n");
    assert!(messages(&both).iter().any(|found| found.contains("there are \"cell\" and \"wrench\"")));
}

/// A text that is cut off anywhere, or in which a part of a line is something else, and what else there may be.
fn broken(text: &str) -> impl Iterator<Item = String> + '_ {
    const STRANGE: [&str; 14] = [
        "",
        "-1",
        "0",
        "1e999",
        "-nan",
        "inf",
        "\"\"",
        "\"ü\"",
        "[]",
        "[[]]",
        "{}",
        "[nan, 1]",
        "true",
        "1979-05-27",
    ];
    let ends = text.char_indices().map(|(end, _)| text[..end].to_owned());
    let values = text.match_indices(" = ").flat_map(move |(at, between)| {
        let begin = at + between.len();
        let end = text[begin..].find('\n').map_or(text.len(), |end| begin + end);
        STRANGE.map(|strange| [&text[..begin], strange, &text[end..]].concat())
    });
    let lines = (0..text.lines().count()).flat_map(move |number| {
        let without = text.lines().enumerate().filter(move |(line, _)| *line != number);
        let twice =
            text.lines().enumerate().flat_map(move |(line, it)| vec![it; 1 + usize::from(line == number)]);
        [without.map(|(_, line)| line).collect::<Vec<_>>().join("\n"), twice.collect::<Vec<_>>().join("\n")]
    });
    ends.chain(values).chain(lines)
}

#[test]
fn no_text_makes_the_reader_panic_and_what_it_refuses_has_a_reason() {
    let mut refused = 0;
    for text in shipped::names().filter_map(shipped::text).chain([CELLS]) {
        for broken in broken(text) {
            let (source, found) = read(&broken);
            assert_eq!(
                source.is_none(),
                found.iter().any(|found| found.severity == Severity::Error),
                "{broken}"
            );
            assert!(source.iter().all(|source| source.decoder().is_some()), "{broken}");
            refused += usize::from(source.is_none());
        }
    }
    assert!(refused > 1_000, "{refused}");
}

proptest::proptest! {
    #[test]
    fn no_characters_make_the_reader_panic(text in "\\PC{0,200}", lines in "[a-z_=\\[\\]\"0-9.\\-\n ]{0,300}") {
        for text in [&text, &lines, &format!("{CELLS}{lines}"), &format!("{lines}\n{CELLS}")] {
            let (source, found) = read(text);
            assert_eq!(source.is_none(), found.iter().any(|found| found.severity == Severity::Error), "{text}");
        }
    }
}

#[test]
fn a_weight_that_forces_are_relative_to_is_read_and_bounded() {
    let with = |line: &str| CELLS.replace("full_n = 50.0", &format!("full_n = 50.0\n{line}"));
    let standing_n = |text: &str| read(text).0.and_then(|source| source.decoder()?.standing_n());
    assert_eq!(standing_n(CELLS), None);
    assert_eq!(standing_n(&with("standing_n = 1.5")), Some(1.5));
    assert_eq!(messages(&with("standing_n = 9")), ["11: \"standing_n\" is 9; it must be 0.5 to 4"]);
}

#[test]
fn the_board_is_the_same_for_who_stands_on_it() {
    let [mut seated, standing] =
        ["balance-board", "balance-board-standing"].map(|name| read(shipped::text(name).unwrap()).0.unwrap());
    if let Measures::Cells(_, reach) = &mut seated.measures {
        reach.standing_n = Some(2.0);
    }
    assert_eq!((seated.origin, seated.measures), (standing.origin, standing.measures));
}

#[test]
fn reports_beside_the_driver_are_those_that_are_known_and_of_cells() {
    let text = shipped::text("balance-board").unwrap();
    let reports = |text: &str| match read(text).0.map(|source| source.origin) {
        Some(Origin::Evdev(evdev)) => evdev.reports,
        _ => None,
    };
    let key = "reports = \"balance-board\"\n";
    assert_eq!(reports(text), Some(Reports::BalanceBoard));
    assert_eq!(reports(&text.replace(key, "")), None);
    let wrong = messages(&text.replace(key, "reports = \"skateboard\"\n"));
    assert!(
        matches!(&wrong[..], [one] if one.ends_with("\"reports\" cannot be \"skateboard\"")),
        "{wrong:?}"
    );
    let tablet = shipped::text("tablet").unwrap();
    let wrong = messages(&tablet.replace("grab = true\n", &format!("grab = true\n{key}")));
    assert!(matches!(&wrong[..], [one] if one.ends_with("\"reports\" are for load cells")), "{wrong:?}");
}

#[test]
fn a_contact_is_of_fingers_or_of_a_tool() {
    let text = |x: &str, y: &str, force: &str| {
        format!(
            "schema = 1\nname = \"pad\"\ntitle = \"A pad\"\n[evdev]\nhas = [\"BTN_TOUCH\"]\n[contact]\nx = \"{x}\"\ny = \"{y}\"\n\
             force = \"{force}\"\n"
        )
    };
    let (fingers, tool) =
        (["ABS_MT_POSITION_X", "ABS_MT_POSITION_Y", "ABS_MT_PRESSURE"], ["ABS_X", "ABS_Y", "ABS_PRESSURE"]);
    for mixture in 0..8 {
        let [x, y, force] = [0, 1, 2].map(|k| if mixture >> k & 1 == 1 { fingers[k] } else { tool[k] });
        let found = messages(&text(x, y, force));
        if mixture % 7 == 0 {
            assert_eq!(found, Vec::<String>::new());
        } else {
            assert_eq!(found, ["6: [contact] mixes axes of fingers, ABS_MT_…, with others"]);
        }
    }
}

#[test]
fn forces_and_places_are_mapped_onto_the_plate() {
    let source = read(CELLS).0.unwrap();
    let decoder = source.decoder().unwrap();
    let uv_per_count = decoder.scale().unwrap().uv_per_count;
    // 25 N on each of the upper cells, in hundredths of a newton: 50 N, which is 5 N on the plate, half way up its rim.
    let mut strain = crate::quantity::Strain::default();
    strain.uv[0] = (2_500.0 * uv_per_count) as f32;
    strain.uv[1] = strain.uv[0];
    let contact = decoder.decode(&strain);
    assert!((contact.fz_n - 5.0).abs() < 1e-4 && contact.x_mm.abs() < 1e-4, "{contact:?}");
    assert!((contact.y_mm - 30.0).abs() < 1e-3, "{contact:?}");
}

#[test]
fn a_wrench_tells_the_place_by_its_moments() {
    let text = "schema = 1\nname = \"six\"\ntitle = \"Six axes\"\n[lines]\n[area]\nhalf_width_mm = 30\nhalf_height_mm = 30\n\
        [force]\nunit = \"N\"\nfull_n = 5.0\n[wrench]\nmoment_unit = \"Nm\"\nheight_mm = 8\n";
    let source = read(text).0.unwrap();
    let (decoder, lines) = (source.decoder().unwrap(), 1e2);
    // 2 N into the plate and shear (0.5, −0.25) at (12, −7), 8 mm above the sensor; M = r × F, in N m.
    let (at, force) = ([12.0, -7.0, 8.0], [0.5, -0.25, -2.0]);
    let moment = [
        at[1] * force[2] - at[2] * force[1],
        at[2] * force[0] - at[0] * force[2],
        at[0] * force[1] - at[1] * force[0],
    ];
    let uv_per_count = decoder.scale().unwrap().uv_per_count;
    let mut strain = crate::quantity::Strain::default();
    let axes = force.into_iter().chain(moment.map(|nmm| nmm * 1e-3));
    for (uv, value) in strain.uv.iter_mut().zip(axes) {
        *uv = (value * lines * uv_per_count) as f32;
    }
    let contact = decoder.decode(&strain);
    let found = [contact.x_mm, contact.y_mm, contact.fx_n, contact.fy_n, contact.fz_n];
    for (found, wanted) in found.into_iter().zip([12.0, -7.0, 0.5, -0.25, 2.0]) {
        assert!((found - wanted).abs() < 1e-4, "{contact:?}");
    }
    assert!(source.has_shear());
}
