//! `mappings/README.md` is the reference of the profiles' language: what it shows and states must hold.

use tactpad::pipeline::mapping::read::check::{OutputChoice, read};
use tactpad::toml_text::diag::Diagnostic;

/// The lines that a profile must have.
const HEAD: &str = "schema = 1\nname = \"Test\"\noutput = \"gamepad\"\n";

const REFERENCE: &str = include_str!("../../mappings/README.md");

#[test]
fn every_example_of_the_reference_is_a_profile() {
    let text = REFERENCE;
    let examples: Vec<_> =
        text.split("```toml\n").skip(1).filter_map(|rest| rest.split("```").next()).collect();
    assert_eq!(examples.len(), 16);
    for example in examples {
        let whole = if example.contains("schema") { example.to_owned() } else { format!("{HEAD}{example}") };
        let (profile, found) = read(&whole, OutputChoice::AsWritten);
        assert_eq!((profile.is_some(), found), (true, vec![]), "{example}");
    }
}

#[test]
fn the_reference_shows_a_finding_as_it_is_told() {
    let shown = REFERENCE.split("```text\n").nth(1).and_then(|rest| rest.split("\n```").next());
    let text = format!("{HEAD}\n[dpad]\nmode = \"5way\"\n");
    let found = read(&text, OutputChoice::AsWritten).1;
    let told: Vec<_> = found.iter().map(|finding| finding.render("mine.toml")).collect();
    assert_eq!(shown, Some(told.join("\n").as_str()));
}

/// The number keys of the reference's tables: section heading, key, default, lowest, highest.
fn documented_numbers() -> Vec<(String, String, Option<f32>, f32, f32)> {
    let mut heading = String::new();
    let mut rows = Vec::new();
    for line in REFERENCE.lines() {
        if line.starts_with('#') {
            heading = line.to_owned();
        }
        let cells: Vec<_> = line.split('|').map(str::trim).collect();
        let [_, key, default, allowed, ..] = cells.as_slice() else { continue };
        let Some((low, high)) = allowed.split_once(" to ") else { continue };
        if let (Ok(low), Ok(high)) = (low.parse(), high.parse()) {
            rows.push((heading.clone(), key.trim_matches('`').to_owned(), default.parse().ok(), low, high));
        }
    }
    rows
}

/// A profile with `line`, which may set `key`, in the table that `heading` documents.
///
/// A key that is bounded by another one gets that other one as a partner, so that only its own range matters.
fn profile_with(heading: &str, key: &str, line: &str) -> String {
    let (partner_table, partner) = match key {
        "centre_radius_mm" if heading.contains("[[stick]]") => ("[[stick]]", "full_radius_mm = 30"),
        "full_radius_mm" if heading.contains("[[stick]]") => ("[[stick]]", "centre_radius_mm = 0"),
        "centre_n" => ("[[stick]]", "from = \"shear\"\nfull_n = 20"),
        "full_n" if heading.contains("[[stick]]") => ("[[stick]]", "from = \"shear\"\ncentre_n = 0"),
        "release_force_n" if heading.contains("[[stick]]") => ("[[stick]]", "min_force_n = 50"),
        "from_n" => ("[[trigger]]", "full_n = 50"),
        "full_n" => ("[[trigger]]", "from_n = 0.05"),
        "for_ms" => ("itself", "min_press_ms = 0"),
        "rest_ms" => ("[access]", "rest_n = 1"),
        "min_press_ms" => ("[[button]]", "long_press_ms = 10000"),
        "long_press_ms" => ("itself", "min_press_ms = 0"),
        "double_press_ms" => ("[[button]]", "long_press_ms = 10000"),
        "radius_hysteresis_mm" => ("[dpad]", "centre_radius_mm = 29"),
        "diagonal_deg" => ("[dpad]", "mode = \"8way\"\nhysteresis_deg = 2"),
        "release_force_n" if heading.contains("[dpad]") => ("[dpad]", "min_force_n = 50"),
        "release_force_n" => ("[pointer]", "min_force_n = 50"),
        "centre_radius_mm" if heading.contains("[pointer]") => ("[pointer]", "full_radius_mm = 30"),
        "full_radius_mm" => ("[pointer]", "centre_radius_mm = 2"),
        "release_n" => ("[[button]]", "press_n = 50"),
        "hard_release_n" => ("[[button]]", "hard_press_n = 50"),
        "tremor_per_mm" => ("[access]", "tremor_hz = 2"),
        "dwell_mm" => ("[[button]]", "dwell_ms = 100"),
        "skip_ms" => ("[[button]]", "hard_press_n = 50\nskip = \"may\""),
        "inner_radius_mm" => ("[[zone]]", "outer_radius_mm = 40"),
        _ => ("", ""),
    };
    let lines_of = |table: &str| {
        let line = if heading.contains(table) { line } else { "" };
        let partner = if partner_table == table { partner } else { "" };
        format!("{line}\n{partner}\n")
    };
    let (root, dpad, button) = (lines_of("itself"), lines_of("[dpad]"), lines_of("[[button]]"));
    let (pointer, gain) = (lines_of("[pointer]"), lines_of("[gain]"));
    let (zone, access) = (lines_of("[[zone]]"), lines_of("[access]"));
    let press = if key == "press_n" || key == "release_n" { "" } else { "press_n = 2" };
    let stages = ["hard_press_n", "hard_release_n", "skip_ms"].contains(&key);
    let [short, long] = if stages { ["light", "hard"] } else { ["tap", "hold"] };
    let tap = format!(r#"{short} = {{ gamepad = "BTN_A", keyboard = "KEY_Z" }}"#);
    let in_hold = if key == "turbo_ms" { format!(", {line}") } else { String::new() };
    let hold = format!(r#"{long} = {{ gamepad = "BTN_B", keyboard = "KEY_X"{in_hold} }}"#);
    let double = match key {
        "double_press_ms" => r#"double = { gamepad = "BTN_X", keyboard = "KEY_C" }"#,
        _ => "",
    };
    let button = if key == "turbo_ms" { String::new() } else { button };
    let step = match key {
        "wait_ms" => line.to_owned(),
        "for_ms" => format!(r#"gamepad = "BTN_TL", keyboard = "KEY_Q", {line}"#),
        _ => r#"gamepad = "BTN_TL", keyboard = "KEY_Q""#.to_owned(),
    };
    let step = step.trim_end_matches(", ");
    let axes = format!(
        "[[stick]]\nstick = \"left\"\n{}[[trigger]]\ntrigger = \"left\"\n{}[[macro]]\nname = \"m\"\nsteps = [{{ {step} }}]\n",
        lines_of("[[stick]]"),
        lines_of("[[trigger]]")
    );
    format!(
        "{HEAD}{root}[access]\n{access}[gain]\n{gain}[dpad]\n{dpad}[pointer]\n{pointer}[[zone]]\nname = \"here\"\n{zone}{axes}[[button]]\nforce = \"fz\"\n{press}\n{tap}\n{hold}\n{double}\n{button}"
    )
}

#[test]
fn the_reference_states_the_ranges_that_hold() {
    let rows = documented_numbers();
    assert_eq!(rows.len(), 56, "{rows:?}");
    for (heading, key, _, low, high) in rows {
        let errors = |value: f32| {
            let text = profile_with(&heading, &key, &format!("{key} = {value}"));
            let found = read(&text, OutputChoice::AsWritten).1;
            let about_range = |finding: &Diagnostic| finding.message.contains("it must be");
            (found.iter().filter(|finding| about_range(finding)).count(), found)
        };
        let step = if key.ends_with("_ms") || key == "filter_samples" { 1.0 } else { 0.01 };
        for (value, wanted) in [(low - step, 1), (low, 0), (high, 0), (high + step, 1)] {
            let (count, found) = errors(value);
            assert_eq!(count, wanted, "{key} = {value}: {found:?}");
        }
    }
}

#[test]
fn the_reference_states_the_defaults_that_hold() {
    let mut checked = 0;
    for (heading, key, default, ..) in documented_numbers() {
        let Some(default) = default else { continue };
        let read_with = |line: &str| read(&profile_with(&heading, &key, line), OutputChoice::AsWritten).0;
        let written = read_with(&format!("{key} = {default}"));
        assert!(written.is_some());
        assert_eq!(written, read_with(""), "{key}");
        checked += 1;
    }
    assert_eq!(checked, 42);
}

#[test]
fn defaults_that_depend_on_other_keys() {
    let text = format!(
        "{HEAD}[dpad]\nmode = \"4way-sticky\"\nmin_force_n = 0.75\n[[button]]\nforce = \"fx\"\npress_n = 5\n\
         out = {{ gamepad = \"BTN_A\", keyboard = \"KEY_Z\" }}\n"
    );
    let (profile, found) = read(&text, OutputChoice::AsWritten);
    let profile = profile.unwrap_or_else(|| panic!("{found:?}"));
    let dpad = profile.dpad.unwrap();
    assert_eq!((dpad.diagonal_deg, dpad.release_force_n), (30.0, 0.5));
    assert_eq!(profile.buttons[0].release_n, 3.5);
}
