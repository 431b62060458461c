//! The page's own files, which are inside the program.

use axum::extract;
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};

use super::refusal::Refusal;

/// Lists files of the folder `page` with their texts.
macro_rules! files {
    ($($name:literal),* $(,)?) => { [$(($name, include_str!(concat!("page/", $name)))),*] };
}

/// The media types of files, by the ends of their names.
const KINDS: [(&str, &str); 4] = [
    (".html", "text/html; charset=utf-8"),
    (".css", "text/css; charset=utf-8"),
    (".js", "text/javascript; charset=utf-8"),
    (".svg", "image/svg+xml"),
];

/// All files of the page.
const FILES: &[(&str, &str)] = &files![
    "doctor.js",
    "fields/addition.js",
    "fields/advice.js",
    "fields/capture.js",
    "fields/chain.js",
    "fields/field.js",
    "fields/form.js",
    "fields/keys.js",
    "fields/number_field.js",
    "fields/schema.js",
    "fields/templates.js",
    "fields/values.js",
    "guides.js",
    "index.html",
    "link/api.js",
    "link/clock.js",
    "link/handshake.js",
    "link/socket.js",
    "live/channels.js",
    "live/events.js",
    "live/instruments.css",
    "live/last_touch.js",
    "live/latency.js",
    "live/live.js",
    "live/status.js",
    "main.js",
    "picture/force_handles.js",
    "picture/geometry.js",
    "picture/handles.js",
    "picture/meter.js",
    "picture/plate.js",
    "picture/plate_binding.js",
    "picture/plate_handles.js",
    "picture/touch.js",
    "picture/trace.js",
    "profile/draft.js",
    "profile/draft_store.js",
    "profile/editor.css",
    "profile/editor.js",
    "profile/history.js",
    "profile/preview.js",
    "profile/profile_history.js",
    "profile/rewind.js",
    "profile/saving.js",
    "profile/sheet.js",
    "profile/text.js",
    "profile/undo_save.js",
    "reports.js",
    "common/announce.js",
    "common/ask.js",
    "common/colours.js",
    "common/command.js",
    "common/dom.js",
    "common/router.js",
    "common/screen.js",
    "common/settings.js",
    "common/tones.js",
    "common/words.js",
    "style.css",
];

/// Answers `GET /`.
pub(super) async fn index() -> Response {
    found("index.html")
}

/// Answers `GET /page/PATH`.
pub(super) async fn file(extract::Path(name): extract::Path<String>) -> Response {
    found(&name)
}

fn found(name: &str) -> Response {
    let text = FILES.iter().find(|(known, _)| *known == name).map(|(_, text)| *text);
    let kind = KINDS.iter().find(|(end, _)| name.ends_with(end)).map(|(_, kind)| *kind);
    match (text, kind) {
        (Some(text), Some(kind)) => ([(header::CONTENT_TYPE, kind)], text).into_response(),
        _ => Refusal::new(StatusCode::NOT_FOUND, "there is no such file").into_response(),
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    #[test]
    fn every_file_of_the_folder_is_served_with_its_kind() {
        let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/src/dashboard/page"));
        let mut names = Vec::new();
        let mut folders = vec![folder.to_path_buf()];
        while let Some(inner) = folders.pop() {
            for path in std::fs::read_dir(inner).unwrap().map(|entry| entry.unwrap().path()) {
                if path.is_dir() {
                    folders.push(path);
                } else {
                    names.push(path.strip_prefix(folder).unwrap().to_str().unwrap().to_owned());
                }
            }
        }
        names.sort();
        let mut known: Vec<_> = FILES.iter().map(|(name, _)| *name).collect();
        known.sort_unstable();
        assert_eq!(names, known);
        assert!(names.iter().all(|name| found(name).status() == StatusCode::OK), "{names:?}");
        assert_eq!(found("../mod.rs").status(), StatusCode::NOT_FOUND);
    }

    #[test]
    fn the_page_loads_nothing_from_elsewhere_and_runs_no_text() {
        for (name, text) in FILES {
            let elsewhere = text.match_indices("://").filter(|(at, _)| {
                let is_socket = text[..*at].ends_with("ws") && text[*at..].starts_with("://${location.host}");
                !is_socket && !text[*at..].starts_with("://www.w3.org/")
            });
            assert_eq!(elsewhere.count(), 0, "{name}");
            for word in
                ["innerHTML", "outerHTML", "insertAdjacentHTML", "document.write", "eval(", "new Function"]
            {
                assert!(!text.contains(word), "{name}: {word}");
            }
        }
    }

    /// What colours become for eyes that lack a kind of cones wholly, in linear RGB: Machado, Oliveira and Fernandes 2009; the first is all three.
    const VISIONS: [[[f64; 3]; 3]; 4] = [
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        [
            [0.152_286, 1.052_583, -0.204_868],
            [0.114_503, 0.786_281, 0.099_216],
            [-0.003_882, -0.048_116, 1.051_998],
        ],
        [
            [0.367_322, 0.860_646, -0.227_968],
            [0.280_085, 0.672_501, 0.047_413],
            [-0.011_820, 0.042_940, 0.968_881],
        ],
        [
            [1.255_528, -0.076_749, -0.178_779],
            [-0.078_411, 0.930_809, 0.147_602],
            [0.004_733, 0.691_367, 0.303_900],
        ],
    ];

    /// So far apart in CIELAB are two colours that are told apart at a glance; 2.3 is seen side by side.
    const APART: f64 = 30.0;

    /// The colour of a custom property in linear RGB, light or dark.
    fn colour(name: &str, is_dark: usize) -> [f64; 3] {
        let style = FILES.iter().find(|(known, _)| *known == "style.css").unwrap().1;
        let value = style.split_once(&format!("{name}: light-dark(")).unwrap().1.split_once(')').unwrap().0;
        let hex = value.split(", ").nth(is_dark).unwrap().trim_start_matches('#');
        [0, 2, 4].map(|at| {
            let share = f64::from(u8::from_str_radix(&hex[at..at + 2], 16).unwrap()) / 255.0;
            if share <= 0.040_45 { share / 12.92 } else { ((share + 0.055) / 1.055).powf(2.4) }
        })
    }

    fn times(rows: &[[f64; 3]; 3], rgb: [f64; 3]) -> [f64; 3] {
        rows.map(|row| row.iter().zip(rgb).map(|(of, part)| of * part).sum::<f64>())
    }

    /// CIE XYZ, of which the second is the luminance.
    fn xyz(rgb: [f64; 3]) -> [f64; 3] {
        times(&[[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]], rgb)
    }

    /// CIELAB, for the white of daylight.
    fn lab(rgb: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = xyz(rgb);
        let [x, y, z] = [x / 0.9505, y, z / 1.089]
            .map(|part| if part > 0.008_856 { part.cbrt() } else { 7.787 * part + 16.0 / 116.0 });
        [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
    }

    #[test]
    fn finger_load_and_threshold_differ_for_every_kind_of_colour_vision_and_from_the_ground() {
        let names = ["--finger", "--load", "--threshold"];
        for is_dark in [0, 1] {
            for (index, name) in names.iter().enumerate() {
                let this = colour(name, is_dark);
                for ground in ["--panel", "--sunk"] {
                    let mut both = [this, colour(ground, is_dark)].map(|rgb| xyz(rgb)[1] + 0.05);
                    both.sort_by(f64::total_cmp);
                    assert!(both[1] / both[0] >= 3.0, "{name} on {ground}: {}", both[1] / both[0]);
                }
                for other in &names[..index] {
                    for vision in &VISIONS {
                        let [one, two] = [this, colour(other, is_dark)]
                            .map(|rgb| lab(times(vision, rgb).map(|part| part.clamp(0.0, 1.0))));
                        let apart =
                            one.iter().zip(two).map(|(one, two)| (one - two).powi(2)).sum::<f64>().sqrt();
                        assert!(apart >= APART, "{name} and {other}, {is_dark}: {apart}");
                    }
                }
            }
        }
    }
}
