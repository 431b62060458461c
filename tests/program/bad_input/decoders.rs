//! Decoders, and the measured contacts that they are made of.

use std::fs;
use std::path::Path;

use tactpad::network::{Network, Zero, onnx};
use tactpad::pad::field::PadField;
use tactpad::pipeline::call::Call;
use tactpad::pipeline::capture::head::Head;
use tactpad::pipeline::capture::writer::CaptureWriter;
use tactpad::pipeline::contact::file as decoder_file;
use tactpad::pipeline::mapping::read::ReadProfile;
use tactpad::pipeline::mapping::read::check::OutputChoice;
use tactpad::pipeline::mapping::read::shipped;
use tactpad::quantity::Contact;
use tactpad::time::HostInstant;

use super::{refuses_line, said, tactpad, with_file};

#[test]
fn a_decoder_that_cannot_play_is_refused() {
    let network = |zero| onnx::write(&Network::untrained(&[4], zero, &[], 1));
    let own = decoder_file::MAGIC;
    let statics = fs::read_to_string("models/statics.toml").unwrap();
    for (bytes, words) in [
        (network(Zero::Raw), &["pad's offset in them", "rows without force"][..]),
        (network(Zero::Tared)[..40].to_vec(), &["no ONNX model", "export it again"]),
        (vec![], &["no ONNX model"]),
        (own.to_vec(), &["is damaged", "tactpad adapt"]),
        (b"tactpad decoder 1\nwhatever".to_vec(), &["no decoder file of this version", "tactpad adapt"]),
        (b"x_mm,y_mm\n1,2\n".to_vec(), &["statics model: line 1", "adapt or train"]),
        (statics.replace("contact_height", "height").into(), &["statics model: line", "models/statics.toml"]),
        (vec![b'a'; 16_000_001], &["larger than 16 MB"]),
    ] {
        let (_folder, path) = with_file("my.decoder", &bytes);
        let path = path.to_str().unwrap();
        for line in [
            "run --pad virtual --output none --decoder",
            "demo --decoder",
            "record /no-such-folder/game.cap --decoder",
            "latency --decoder",
        ] {
            let words: Vec<_> = [&[path, "cannot be read"], words].concat();
            refuses_line(&format!("{line} {path}"), &words);
        }
    }
    for method in ["linear", "knn"] {
        let (folder, path) = with_file("m.csv", &measured(30, |_, _| ()));
        let decoder = folder.path().join("my.decoder").display().to_string();
        let line = ["adapt", "--method", method, "--measured", path.to_str().unwrap(), "--out", &decoder];
        let adapted = tactpad().args(line).output().unwrap();
        assert_eq!(adapted.status.code(), Some(0), "{}", said(&adapted));
        for line in ["run --pad virtual --output none", "demo", "record no-such.cap", "latency"] {
            refuses_line(
                &format!("{line} --decoder {decoder}"),
                &[method, "cannot play", "evaluate and replay take it", "adapt --method inverse"],
            );
        }
    }
    refuses_line("demo --decoder nope", &["decoder nope", "No such file"]);
    refuses_line("demo --decoder /tmp", &["/tmp", "it is no file"]);
    refuses_line("replay --contacts any.csv --profile contra --decoder scdf", &["decoded already"]);
}

#[test]
fn a_capture_whose_decoder_cannot_be_read_says_so() {
    let mut bytes = Vec::new();
    let profile = ReadProfile::read(shipped::text("contra").unwrap(), OutputChoice::AsWritten).0;
    let head = Head { decoder: Some(b"\x01".into()), profile };
    let mut writer = CaptureWriter::begin(&mut bytes, HostInstant::default(), &head).unwrap();
    writer.write(HostInstant::default(), Call::Timeout).unwrap();
    let (_folder, path) = with_file("game.cap", &bytes);
    let path = path.to_str().unwrap();
    refuses_line(&format!("replay {path}"), &[path, "a decoder that cannot be read", "--decoder"]);
    let chosen = tactpad().args(["replay", path, "--decoder", "statics"]).output().unwrap();
    assert_eq!(chosen.status.code(), Some(0), "{}", said(&chosen));
}

/// A measured table of an untouched pad and `contacts` presses, its cells changed.
fn measured(contacts: usize, change: impl Fn(usize, &mut Vec<String>)) -> Vec<u8> {
    let names =
        "session,x_mm,y_mm,fx_n,fy_n,fz_n,m0x_uv,m0y_uv,m0z_uv,m1x_uv,m1y_uv,m1z_uv,m2x_uv,m2y_uv,m2z_uv";
    let signals = PadField::nominal().signals;
    let press = |k: usize| {
        let [x_mm, y_mm, fz_n] = [k % 20, k % 13, 1 + k % 5].map(|number| number as f32);
        let uv = signals.strain_uv(&Contact { x_mm, y_mm, fz_n, ..Contact::default() }).uv;
        format!("press,{x_mm},{y_mm},0,0,{fz_n},{}", uv.map(|uv| uv.to_string()).join(","))
    };
    let rows = [names.to_owned(), "zero,0,0,0,0,0,0,0,0,0,0,0,0,0,0".into()];
    let rows = rows.into_iter().chain((0..contacts).map(press)).enumerate().map(|(line, row)| {
        let mut cells = row.split(',').map(str::to_owned).collect();
        change(line + 1, &mut cells);
        cells.join(",") + "\n"
    });
    rows.collect::<String>().into()
}

/// The verbs that read a measured table.
const TAKERS: [&str; 7] = [
    "adapt --method inverse --out never --measured",
    "adapt --method wrench --out never --measured",
    "adapt --method linear --out never --measured",
    "adapt --method knn --out never --measured",
    "adapt --method scdf --from scdf --out never --measured",
    "evaluate --measured",
    "evaluate --decoder scdf --measured",
];

#[test]
fn measured_contacts_that_lack_something_are_refused_with_file_and_line() {
    let without = |from: usize, count: usize| {
        measured(20, |_, cells| {
            cells.drain(from..from + count);
        })
    };
    let cell = |text: &'static str| {
        measured(20, move |line, cells| {
            if line == 7 {
                cells[10] = text.into();
            }
        })
    };
    for (table, line, words) in [
        (without(6, 9), 1, &["no column is a channel", "m0x_uv to m2z_uv"][..]),
        (without(11, 1), 1, &["no column is named m1z_uv", "all nine channels"]),
        (without(8, 2), 1, &["no column is named m0z_uv, m1x_uv"]),
        (without(5, 1), 1, &["no column is named fz_n", "expected is"]),
        (without(1, 2), 1, &["no column is named x_mm, y_mm"]),
        (cell("NaN"), 7, &["m1y_uv is \"NaN\", which is not a number"]),
        (cell("-inf"), 7, &["m1y_uv is \"-inf\", which is not a number"]),
        (cell(""), 7, &["m1y_uv is empty", "leave the row out"]),
        (cell("1e9"), 7, &["m1y_uv is 1e9, and"]),
        (cell("1,2"), 7, &["16 values where the header names 15 columns"]),
        (
            measured(0, |line, cells| {
                if line > 1 {
                    cells.clear();
                }
            }),
            2,
            &["no contact follows"],
        ),
    ] {
        let (_folder, path) = with_file("m.csv", &table);
        let path = path.to_str().unwrap();
        let place = format!("{path}:{line}: ");
        let words: Vec<_> = [&[place.as_str()], words].concat();
        TAKERS.iter().for_each(|taker| refuses_line(&format!("{taker} {path}"), &words));
    }
    assert!(!Path::new("never").exists());
}

#[test]
fn what_adapt_cannot_begin_with_or_join_is_said() {
    let (_folder, tared) = with_file("m.csv", &measured(20, |_, _| ()));
    let tared = tared.to_str().unwrap();
    for method in ["wrench", "linear", "knn"] {
        let line = format!("adapt --method {method} --from scdf --out never --measured {tared}");
        refuses_line(&line, &["--from is for inverse and scdf", "measured contacts alone"]);
    }
    let line = format!("adapt --method inverse --from statics --out never --measured {tared}");
    refuses_line(&line, &["--from statics is a statics decoder", "adapt --method inverse"]);
    let line = format!("adapt --method inverse --rows 0 --out never --measured {tared}");
    refuses_line(&line, &["--rows", "1 or more", "without --rows all are taken"]);
    let pressed = measured(20, |line, cells| {
        if line == 2 {
            (cells[0], cells[5]) = ("press".into(), "1".into());
        }
    });
    let (_folder, raw) = with_file("raw.csv", &pressed);
    let raw = raw.to_str().unwrap();
    let line = format!("adapt --method wrench --out never --measured {tared} --measured {raw}");
    refuses_line(&line, &[tared, raw, "1 of these 2 tables read the untouched pad"]);
    assert!(!Path::new("never").exists());
}

#[test]
fn fits_to_fewer_contacts_than_they_have_numbers_are_refused() {
    for (method, least) in [("wrench", 10), ("linear", 10), ("knn", 5), ("scdf --from scdf", 10)] {
        let (_folder, path) = with_file("m.csv", &measured(least - 1, |_, _| ()));
        let path = path.to_str().unwrap();
        let (most, least) = ((least - 1).to_string(), format!("{least} contacts"));
        let line = format!("adapt --method {method} --out never --measured {path}");
        refuses_line(&line, &[path, &least, &most, "measure more"]);
    }
    let untared = measured(20, |line, cells| {
        if line == 2 {
            (cells[0], cells[5]) = ("press".into(), "1".into());
        }
    });
    let (_folder, path) = with_file("m.csv", &untared);
    let path = path.to_str().unwrap();
    refuses_line(&format!("evaluate --measured {path}"), &[path, "no row without force", "measure some"]);
    assert!(!Path::new("never").exists());
}

#[test]
fn a_truth_of_other_rows_is_refused() {
    let (_folder, path) = with_file("m.csv", &measured(20, |_, _| ()));
    let (_folder_of_truth, truth) = with_file("t.csv", b"x_mm,y_mm,fx_n,fy_n,fz_n\n0,0,0,0,1\n");
    let (path, truth) = (path.to_str().unwrap(), truth.to_str().unwrap());
    let line = format!("evaluate --measured {path} --truth");
    refuses_line(&format!("{line} {truth}"), &[path, "21 rows", "its truth 1", "of one run"]);
    refuses_line(&format!("{line} /no-such.csv"), &["/no-such.csv", "cannot be read"]);
}
