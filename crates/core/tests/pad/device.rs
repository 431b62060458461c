//! Device files: what is refused, where and why; what is read, laid over and written.
//!
//! A file in `crates/core/tests/pad/device` holds comment lines `# error: LINE:COLUMN message`, each optionally followed by
//! `# help: text`, for everything that it is expected to raise, in order. Those in `crates/core/tests/pad/device/imperfections` are
//! laid over the nominal device.

#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use proptest::prelude::{Just, Strategy, any, prop, prop_assert, prop_assert_eq, prop_oneof, proptest};
use tactpad_core::pad::device::behaviour::{Behaviour, Crosstalk, ModuleCrosstalk, OnChannels};
use tactpad_core::pad::device::parameter::Parameter;
use tactpad_core::pad::device::schema::Effect;
use tactpad_core::pad::device::unit::Unit;
use tactpad_core::pad::device::{Device, Module, Side};
use tactpad_core::quantity::CHANNELS;
use tactpad_core::toml_text::TEXT_BYTES_MAX;
use tactpad_core::toml_text::diag::Diagnostic;
use tactpad_numeric::memory::{PlayOperator, Relaxation};

#[cfg(target_os = "linux")]
use crate::worked::worked;

const NOMINAL: &str = include_str!("../../../../models/sstid.toml");

type Reading = (Option<Device>, Vec<Diagnostic>);

fn tomls(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let mut paths: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "toml"));
    paths.sort();
    paths
}

fn annotation(Diagnostic { severity, message, line, column, help, .. }: &Diagnostic) -> String {
    let help = help.as_ref().map(|help| format!("\n# help: {help}")).unwrap_or_default();
    format!("# {severity}: {line}:{column} {message}{help}")
}

/// What the annotated files of a folder raise and should not, or the other way round.
fn unexpected(folder: &str, read: impl Fn(&str) -> Reading) -> String {
    let mut failures = String::new();
    for path in tomls(folder) {
        let text = fs::read_to_string(&path).unwrap();
        let (device, found) = read(&text);
        let shown = found.iter().map(annotation).collect::<Vec<_>>().join("\n");
        let marked = |line: &&str| line.starts_with("# error: ") || line.starts_with("# help: ");
        let expected = text.lines().filter(marked).collect::<Vec<_>>().join("\n");
        if shown != expected {
            failures += &format!("{}\nexpected:\n{expected}\nfound:\n{shown}\n\n", path.display());
        }
        assert_eq!(
            device.is_none(),
            !found.is_empty(),
            "{}: a device exactly without errors",
            path.display()
        );
    }
    failures
}

#[test]
fn annotated_devices_raise_exactly_what_they_say() {
    assert!(tomls("tests/pad/device").len() >= 10);
    let failures = unexpected("tests/pad/device", Device::from_toml);
    assert!(failures.is_empty(), "{failures}");
}

#[test]
fn annotated_imperfections_raise_exactly_what_they_say() {
    assert!(tomls("tests/pad/device/imperfections").len() >= 3);
    let nominal = Device::nominal();
    let failures = unexpected("tests/pad/device/imperfections", |text| nominal.with_imperfections(text));
    assert!(failures.is_empty(), "{failures}");
}

/// The nominal device file with its first `from` replaced.
fn edited(from: &str, to: &str) -> String {
    assert!(NOMINAL.contains(from), "{from}");
    NOMINAL.replacen(from, to, 1)
}

#[test]
fn one_impossible_number_is_refused_in_its_line_with_the_reason() {
    // What is written instead of what, in which line it is refused, and the words of the refusal.
    let cases = [
        ("[0.0, 120.0, 240.0]", "[0, 2.094, 4.189]", "angles_deg", "write [0.0, 120.0, 240.0]"),
        ("[0.0, 120.0, 240.0]", "[0, 2.094, 240]", "angles_deg", "modules 0 and 1 overlap"),
        ("[0.0, 120.0, 240.0]", "[0, 2.094, 240]", "angles_deg", "in radians, write 120.0"),
        ("[0.0, 120.0, 240.0]", "[0, 240, 120]", "angles_deg", "must ascend: 120 comes after 240"),
        ("[0.0, 120.0, 240.0]", "[0, 120, 120]", "angles_deg", "must ascend"),
        ("[0.0, 120.0, 240.0]", "[0, 120, 360]", "angles_deg", "one turn"),
        ("[0.0, 120.0, 240.0]", "[-5, 120, 352]", "angles_deg", "modules 0 and 2 overlap"),
        ("centre_radius_mm = 20.0", "centre_radius_mm = 4", "centre_radius_mm", "modules 0 and 1 overlap"),
        ("centre_radius_mm = 20.0", "centre_radius_mm = 27", "centre_radius_mm", "module 0 leaves the plate"),
        ("film_length_x_mm = 9.8", "film_length_x_mm = 65", "film_length_x_mm", "overlap"),
        ("frame_width_mm = 0.8", "frame_width_mm = 2.7", "frame_width_mm", "leaves no window"),
        ("post_length_x_mm = 2.0", "post_length_x_mm = 8.2", "post_length_x_mm", "write less than 8.2"),
        ("post_width_y_mm = 1.4", "post_width_y_mm = 5", "post_width_y_mm", "does not fit"),
        ("x = -3.3", "x = -4.31", "x = -4.31", "along x it reaches 4.91 mm"),
        ("y = -1.0", "y = -2.5", "y = -2.5", "gauge R3 leaves the film"),
        ("x = 3.3", "x = 1.5", "x = 1.1", "gauges R2 and R6 overlap"),
        ("max_centre_radius_mm = 29.0", "max_centre_radius_mm = 29.5", "max_centre", "reaches 30.5 mm"),
        ("patch_radius_mm = 1.0", "patch_radius_mm = 1.1", "max_centre", "leaves the plate"),
        ("diameter_mm = 60.0", "diameter_mm = 40", "centre_radius_mm", "leaves the plate"),
    ];
    for (from, to, key, words) in cases {
        let text = edited(from, to);
        let (device, found) = Device::from_toml(&text);
        let told = |it: &Diagnostic| {
            text.lines().nth(it.line - 1).is_some_and(|line| line.contains(key))
                && it.render("").contains(words)
        };
        assert!(device.is_none() && found.iter().any(told), "{to}: {found:#?}");
        assert!(found.len() <= 2, "{to}: {found:#?}");
    }
}

#[test]
fn no_number_of_the_nominal_device_passes_in_another_unit() {
    let nominal = Device::nominal();
    let mut tried = 0;
    for parameter in Parameter::all() {
        let factors: &[f64] = match parameter.unit() {
            Unit::Millimetre => &[1e-3, 1e3],
            Unit::Megapascal => &[1e-3, 1e3, 1e6],
            Unit::Degree => &[1.0_f64.to_radians()],
            Unit::Volt | Unit::Newton => &[1e3],
            Unit::Hertz => &[1e-3, 1e3],
            Unit::Celsius => &[298.15 / 25.0],
            // Of these, the nominal device's are zero or ratios; or a range from a sample to a session tells nothing.
            _ => &[],
        };
        let value = parameter.get(&nominal);
        for factor in factors.iter().filter(|_| value != 0.0) {
            let mut device = nominal.clone();
            parameter.set(&mut device, value * factor);
            assert!(Device::from_toml(&device.to_toml()).0.is_none(), "{parameter} = {}", value * factor);
            tried += 1;
        }
    }
    assert_eq!(tried, 2 * (2 + 1 + 11 + 2 + 2 * 7 + 6) + 3 * 7 + 2 + 1 + 1 + 2 + 1);
}

#[test]
fn gauges_go_by_their_names_and_whole_numbers_are_numbers() {
    let (device, found) = Device::from_toml(include_str!("device/in-order.toml"));
    assert_eq!((device, found), (Some(Device { reported: None, ..Device::nominal() }), vec![]));
}

#[test]
fn the_last_possible_number_is_read() {
    for (from, to) in [
        ("[0.0, 120.0, 240.0]", "[-120, 0, 120]"),
        ("centre_radius_mm = 20.0", "centre_radius_mm = 26.8"),
        ("centre_radius_mm = 20.0", "centre_radius_mm = 8"),
        ("frame_width_mm = 0.8", "frame_width_mm = 1.9"),
        ("post_length_x_mm = 2.0", "post_length_x_mm = 8.1"),
        ("x = -3.3", "x = -4.3"),
        ("x = 3.3", "x = 2.1"),
        ("diameter_mm = 60.0", "diameter_mm = 60.0000"),
        ("thickness_mm = 1.0", "thickness_mm = 1.15"),
        ("nu = 0.29", "nu = 0.49"),
    ] {
        assert_eq!(Device::from_toml(&edited(from, to)).1, vec![], "{to}");
    }
}

#[test]
fn imperfections_change_what_they_write_and_nothing_else() {
    let nominal = Device::nominal();
    let laid = |device: &Device, text: &str| device.with_imperfections(text).0.unwrap();
    let moved = laid(&nominal, "[[module]]\nindex = 1\nradial_mm = -0.7\ngain = [1, 1.12, 1]\n");
    let mut expected = nominal.clone();
    expected.modules[1] = Module { radial_mm: -0.7, gain: [1.0, 1.12, 1.0], ..Module::NOMINAL };
    assert_eq!(moved, expected);
    let more = laid(
        &moved,
        "schema = \"sstid-device/1\"\n[[module]]\nindex = 1\nframe_open = \"-x\"\ngain = [2, 2, 2]\n",
    );
    expected.modules[1].frame_open = Some(Side::MinusX);
    expected.modules[1].gain = [2.0; 3];
    assert_eq!(more, expected);
    assert_eq!(
        Device::from_toml(&more.to_toml()),
        (Some(more.clone()), vec![]),
        "a saved device is complete"
    );
    assert_eq!(laid(&more, ""), more);
}

#[test]
fn the_same_tables_in_a_device_file_and_over_it_are_the_same_device() {
    for text in [include_str!("device/imperfections/in-order.toml"), BEHAVIOUR] {
        let inside = Device::from_toml(&format!("{NOMINAL}\n{text}")).0;
        assert!(inside.is_some());
        assert_eq!(inside, Device::nominal().with_imperfections(text).0);
    }
}

/// Every table of behaviour.
const BEHAVIOUR: &str = include_str!("device/imperfections/behaviour.toml");

#[test]
fn behaviour_is_read_as_it_is_written() {
    let device = Device::nominal().with_imperfections(BEHAVIOUR).0.unwrap();
    assert_eq!(device.contact.patch_radius_mm, 0.8);
    let Behaviour { thermal, crosstalk, module_crosstalk, hysteresis, creep, rig, .. } = &device.behaviour;
    assert_eq!((thermal.reference_c, thermal.zero_uv_per_c), (22.5, [30.0; CHANNELS]));
    assert_eq!(thermal.gain_per_c[8], -0.0009);
    assert_eq!(thermal.zero_uv_per_c2, [0.0; CHANNELS], "what is not written is ideal");
    assert_eq!(
        crosstalk,
        &[Crosstalk { channel: 5, with: 2, share: 0.03 }, Crosstalk { channel: 2, with: 5, share: -0.01 }]
    );
    assert_eq!(module_crosstalk, &[ModuleCrosstalk { module: 2, with: 0, share: 0.002 }]);
    let z_only = [false, false, true, false, false, true, false, false, true];
    assert_eq!(
        hysteresis,
        &[
            OnChannels::all(PlayOperator { threshold: 20.0, share: 0.5 }),
            OnChannels { channels: z_only, law: PlayOperator { threshold: 200.0, share: 0.25 } }
        ]
    );
    assert_eq!(creep, &[OnChannels::all(Relaxation { time_s: 30.0, share: 0.02 })]);
    assert_eq!(rig.reference_zero_n, [0.01, -0.02, 0.03]);
    assert_eq!(Device::from_toml(&device.to_toml()), (Some(device.clone()), vec![]));
}

#[test]
fn one_number_for_nine_is_that_number_nine_times_and_written_so() {
    let laid = |text: &str| Device::nominal().with_imperfections(text).0.unwrap();
    let short = laid("[noise]\nadditive_uv = 2.5\n");
    assert_eq!(short, laid("[noise]\nadditive_uv = [2.5, 2.5, 2.5, 2.5, 2.5, 2.5, 2.5, 2.5, 2.5]\n"));
    assert!(short.to_toml().contains("\n[noise]\nadditive_uv = 2.5 #"));
    let told = Device::nominal().with_imperfections("[noise]\nadditive_uv = -1\n").1;
    assert_eq!(told.len(), 1, "one number is refused once: {told:?}");
}

#[test]
fn over_a_device_keys_replace_keys_and_lists_replace_lists() {
    let device = Device::nominal().with_imperfections(BEHAVIOUR).0.unwrap();
    let laid = |text: &str| device.with_imperfections(text).0.unwrap();
    let mut expected = device.clone();
    expected.behaviour.thermal.reference_c = 20.0;
    assert_eq!(laid("[thermal]\nreference_c = 20\n"), expected);
    let mut expected = device.clone();
    expected.behaviour.creep = vec![OnChannels::all(Relaxation { time_s: 5.0, share: 0.1 })];
    assert_eq!(laid("[[creep]]\ntime_s = 5\nshare = 0.1\n"), expected);
    let mut expected = device.clone();
    expected.behaviour.crosstalk.clear();
    assert_eq!(laid("crosstalk = []\n"), expected);
}

#[test]
fn terms_of_a_sum_are_counted() {
    let terms = |count: u32| (1..=count).map(|time| format!("[[creep]]\ntime_s = {time}\nshare = 0.01\n"));
    let laid = |count| Device::nominal().with_imperfections(&terms(count).collect::<String>());
    assert_eq!(laid(144).1, vec![]);
    let (device, told) = laid(145);
    assert!(device.is_none() && told.len() == 1, "{told:?}");
    assert!(told[0].line == 433 && told[0].message.contains("more than 144"), "{told:?}");
    assert_eq!(laid(1_000).1, told, "and no more is said");
}

#[test]
fn a_debonded_side_stays_where_only_the_share_changes() {
    let laid = |device: &Device, text: &str| device.with_imperfections(text).0.unwrap();
    let loose =
        laid(&Device::nominal(), "[[module]]\nindex = 1\ndebonded_share = 0.2\ndebonded_side = \"-y\"\n");
    assert_eq!(loose.modules[1].debonded(), Some((Side::MinusY, 0.2)));
    let looser = laid(&loose, "[[module]]\nindex = 1\ndebonded_share = 0.4\n");
    assert_eq!(looser.modules[1].debonded(), Some((Side::MinusY, 0.4)));
    assert_eq!(Device::from_toml(&looser.to_toml()), (Some(looser.clone()), vec![]));
    let mended = laid(&looser, "[[module]]\nindex = 1\ndebonded_share = 0\n");
    assert_eq!(mended, Device::nominal());
}

#[test]
fn the_fingers_patch_is_the_contacts() {
    let nominal = Device::nominal();
    let over = |text: &str| nominal.with_imperfections(text);
    let small = over("[finger]\npatch_radius_mm = 0.5\n").0.unwrap();
    assert_eq!(small.contact.patch_radius_mm, 0.5);
    assert_ne!(small.fingerprint(), nominal.fingerprint());
    assert_eq!(over("[finger]\nwander_mm = 0.5\n").0.unwrap().fingerprint(), nominal.fingerprint());
    let told = &over("# A thumb.\n[finger]\npatch_radius_mm = 2\n").1[0];
    assert_eq!((told.line, told.column), (3, 19));
    assert!(told.message.contains("leaves the plate"), "{told:?}");
}

#[test]
fn a_fingerprint_is_that_of_the_numbers_and_not_of_the_text() {
    let nominal = Device::nominal();
    let rewritten = Device::from_toml(&nominal.to_toml()).0.unwrap();
    assert_eq!(rewritten.fingerprint(), nominal.fingerprint());
    let over = |text: &str| nominal.with_imperfections(text).0.unwrap().fingerprint();
    assert_eq!(over("[[module]]\nindex = 0\ngain = [2, 1, 1]\noffset_uv = [5, 5, 5]"), nominal.fingerprint());
    assert_ne!(over("[[module]]\nindex = 0\nradial_mm = 1e-9"), nominal.fingerprint());
}

#[test]
fn a_text_is_read_up_to_its_limit() {
    let filled = |length: usize| format!("{NOMINAL}{}", "\n".repeat(length - NOMINAL.len()));
    assert_eq!(Device::from_toml(&filled(TEXT_BYTES_MAX)).1, vec![]);
    for (device, found) in [Device::from_toml, |text: &str| Device::nominal().with_imperfections(text)]
        .map(|read| read(&filled(TEXT_BYTES_MAX + 1)))
    {
        assert!(device.is_none() && found[0].message.contains("longer than 256 kB"), "{found:?}");
    }
}

#[test]
fn the_example_of_the_reference_can_be_laid_over_the_nominal_device() {
    let (_, rest) = include_str!("../../../../models/README.md").split_once("```toml\n").unwrap();
    let (example, rest) = rest.split_once("```").unwrap();
    assert!(!rest.contains("```"), "another example is not tested");
    let (device, found) = Device::nominal().with_imperfections(example);
    assert_eq!(found, vec![]);
    assert_eq!(device.unwrap().modules[2].frame_e_factor, 0.6);
}

#[test]
fn the_shipped_imperfections_can_be_laid_over_the_nominal_device() {
    let nominal = Device::nominal();
    let paths = tomls("../../models/imperfections");
    assert!(paths.len() >= 4);
    for path in paths {
        let (device, found) = nominal.with_imperfections(&fs::read_to_string(&path).unwrap());
        assert_eq!(found, vec![], "{}", path.display());
        assert!(device.is_some_and(|device| device != nominal), "{} changes nothing", path.display());
    }
}

#[test]
fn the_siblings_gains_are_its_published_sensitivities_over_simulated_ones() {
    let text = include_str!("../../../../models/imperfections/gains.toml");
    let device = Device::nominal().with_imperfections(text).0.unwrap();
    let measured = [[794.0, 864.0, 276.0], [808.0, 819.0, 329.0], [799.0, 863.0, 278.0]];
    for (module, measured) in device.modules.iter().zip(measured) {
        for ((gain, measured), simulated) in module.gain.iter().zip(measured).zip([629.0, 649.0, 331.0]) {
            assert!(
                (gain - measured / simulated).abs() <= 0.0005 + 1e-12,
                "{gain}: {measured} / {simulated}"
            );
        }
    }
}

#[cfg(target_os = "linux")]
#[test]
fn checking_is_bounded_whatever_the_text() {
    let table = |head: &str| {
        let keys = (0..).map(|number| format!("film_length_{number} = 1\n"));
        let text = keys.take(11_000).fold(head.to_owned(), |text, key| text + &key);
        text[..text.len().min(TEXT_BYTES_MAX)].to_owned()
    };
    let gauge = "[[gauge]]\nname = \"R1\"\n";
    let texts =
        [table(""), table("[stack]\n"), table("[[module]]\n"), gauge.repeat(TEXT_BYTES_MAX / gauge.len())];
    for text in texts {
        assert!(text.len() > TEXT_BYTES_MAX - 30_000, "{}", text.len());
        let start = worked();
        let (device, found) = Device::from_toml(&text);
        let took = worked() - start;
        assert!(device.is_none() && found.len() <= 51);
        assert!(took < Duration::from_secs(1), "{}: {took:?}", &text[..20]);
    }
}

/// Rows `| `key` | unit | low to high | …` of the reference, as (key, unit, low, high).
fn documented() -> Vec<(String, String, f64, f64)> {
    let rows = include_str!("../../../../models/README.md").lines().filter_map(|line| {
        let cells: Vec<_> = line.split('|').map(str::trim).collect();
        let [_, key, unit, range, ..] = cells.as_slice() else { return None };
        let (low, high) = range.split_once(" to ")?;
        Some((key.trim_matches('`').to_owned(), (*unit).to_owned(), low.parse().ok()?, high.parse().ok()?))
    });
    rows.collect()
}

/// The name of a parameter with what is counted replaced by `N` and elements of lists left out.
fn documented_name(parameter: Parameter) -> String {
    let words: Vec<_> = parameter.name().split('.').collect();
    match words.as_slice() {
        ["gauge" | "module", _, key, ..] => format!("{}.N.{key}", words[0]),
        ["material", ..] => words.join("."),
        [table, key, ..] => format!("{table}.{key}"),
        words => words.join("."),
    }
}

#[test]
fn the_reference_states_every_number_with_its_unit_and_range() {
    let documented = documented();
    let mut found = Vec::new();
    for parameter in Parameter::all() {
        let (low, high) = parameter.range();
        found.push((documented_name(parameter), parameter.unit().symbol().to_owned(), low, high));
    }
    found.dedup();
    for row in &found {
        assert!(documented.contains(row), "models/README.md lacks {row:?}");
    }
    for row in documented.iter().filter(|(name, ..)| list_of(name).is_none()) {
        assert!(found.contains(row), "no device has {row:?}");
    }
}

#[test]
fn the_reference_states_what_is_there_where_nothing_is_written() {
    let nominal = Device::nominal();
    let mut stated = 0;
    for line in include_str!("../../../../models/README.md").lines() {
        let cells: Vec<_> = line.split('|').map(str::trim).collect();
        let [_, key, _, _, default, _, _] = cells.as_slice() else { continue };
        let Ok(default) = default.parse::<f64>() else { continue };
        for parameter in Parameter::all() {
            if documented_name(parameter) == key.trim_matches('`') {
                assert_eq!(parameter.get(&nominal), default, "{parameter}");
                stated += 1;
            }
        }
    }
    let behaviour = Parameter::all().filter(|parameter| parameter.effect() == Effect::Behaviour).count();
    assert_eq!(stated, behaviour);
}

/// The tables that may stand more than once, each with what a table of it must have beside the key that is looked at.
const LISTS: [(&str, &str); 4] = [
    ("crosstalk", "channel = \"m1z\"\nwith = \"m0z\"\n"),
    ("module_crosstalk", "module = 0\nwith = 1\n"),
    ("hysteresis", "threshold_uv = 10\nshare = 0.1\n"),
    ("creep", "time_s = 30\nshare = 0.1\n"),
];

/// The list that a documented name is about, and its key there.
fn list_of(name: &str) -> Option<((&'static str, &'static str), &str)> {
    let (table, key) = name.split_once(".N.")?;
    LISTS.into_iter().find(|(list, _)| *list == table).map(|list| (list, key))
}

#[test]
fn the_reference_states_every_number_of_the_lists_with_its_range() {
    let nominal = Device::nominal();
    let mut tried = Vec::new();
    for (name, unit, low, high) in documented() {
        let Some(((table, rest), key)) = list_of(&name) else { continue };
        let others: String =
            rest.lines().filter(|line| !line.starts_with(key)).map(|line| format!("{line}\n")).collect();
        let laid =
            |value: f64| nominal.with_imperfections(&format!("[[{table}]]\n{others}{key} = {value:?}\n"));
        for value in [low, high] {
            assert_eq!(laid(value).1, vec![], "{name} = {value}");
        }
        for value in [low - 1e-6 * (high - low), high + 1e-6 * (high - low)] {
            let told = laid(value).1;
            let range = format!("it must be {low} to {high} {unit}");
            assert!(told.len() == 1 && told[0].message.ends_with(range.trim_end()), "{name}: {told:?}");
        }
        tried.push(name);
    }
    for (table, _) in LISTS {
        let told = nominal.with_imperfections(&format!("[[{table}]]\nqqqqqqqqqq = 1\n")).1;
        let keys = told.iter().find_map(|it| it.help.as_ref()?.strip_prefix("known here: "));
        let keys = keys.unwrap().split(", ");
        for key in keys.filter(|key| !["channel", "module", "with", "channels"].contains(key)) {
            assert!(tried.contains(&format!("{table}.N.{key}")), "models/README.md lacks {table} {key}");
        }
    }
}

/// A file with a word of it replaced, left out or repeated.
fn mutated(file: &'static str) -> impl Strategy<Value = String> {
    let word = prop_oneof![
        prop_oneof![Just("0"), Just("-1"), Just("nan"), Just("1e308"), Just("-inf"), Just("0x7f"), Just("3")],
        prop_oneof![
            Just("[["),
            Just("]"),
            Just("="),
            Just("\""),
            Just("{"),
            Just("\n"),
            Just("# "),
            Just("ä")
        ],
        prop_oneof![Just("\"x\""), Just("true"), Just("[]"), Just("[0, 1e-9, 2]"), Just("plate"), Just("")],
    ];
    prop::collection::vec((any::<prop::sample::Index>(), word), 1..4).prop_map(|edits| {
        let mut words: Vec<&str> = file.split_inclusive([' ', '\n']).collect();
        for (index, word) in edits {
            let index = index.index(words.len());
            words.splice(index..=index, [word, "\n"]);
        }
        words.concat()
    })
}

/// A device that is possible has only finite numbers within their ranges.
fn is_sound(device: &Device) -> bool {
    Parameter::all().all(|parameter| {
        let (low, high) = parameter.range();
        (low..=high).contains(&parameter.get(device))
    })
}

proptest! {
    #[test]
    fn any_text_has_a_device_or_a_reason(text in prop_oneof![any::<String>(), mutated(NOMINAL), mutated(BEHAVIOUR)]) {
        let nominal = Device::nominal();
        for (device, found) in [Device::from_toml(&text), nominal.with_imperfections(&text)] {
            prop_assert_eq!(device.is_none(), !found.is_empty());
            prop_assert!(found.iter().all(|finding| finding.line > 0 && finding.column > 0));
            prop_assert!(device.is_none_or(|device| is_sound(&device)));
        }
    }

    #[test]
    fn what_is_read_is_written_to_the_last_digit(
        shifts in prop::collection::vec(-1.0..1.0_f64, 8 * 3),
        gains in prop::collection::vec(-1.5..1.5_f64, 6 * 3),
    ) {
        let mut device = Device::nominal();
        let (gain, shift): (Vec<_>, Vec<_>) = Parameter::all()
            .filter(|parameter| parameter.module().is_some() && !parameter.name().contains("debonded"))
            .partition(|parameter| parameter.name().contains("gain") || parameter.name().contains("offset"));
        shift.iter().zip(&shifts).for_each(|(parameter, shift)| {
            let value = parameter.get(&device);
            parameter.set(&mut device, value + 0.9 * shift);
        });
        gain.iter().zip(&gains).for_each(|(parameter, gain)| parameter.set(&mut device, *gain));
        let (read, found) = Device::from_toml(&device.to_toml());
        prop_assert_eq!((read, found), (Some(device), vec![]));
    }
}
