//! The page's own files, which are inside the program.

use axum::extract::Path;
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
    "announce.js",
    "api.js",
    "capture.js",
    "channels.js",
    "clock.js",
    "colours.js",
    "command.js",
    "doctor.js",
    "dom.js",
    "draft.js",
    "draft_store.js",
    "editor.css",
    "editor.js",
    "events.js",
    "field.js",
    "force_handles.js",
    "form.js",
    "geometry.js",
    "guides.js",
    "handles.js",
    "handshake.js",
    "history.js",
    "index.html",
    "instruments.css",
    "keys.js",
    "latency.js",
    "live.js",
    "main.js",
    "meter.js",
    "number_field.js",
    "plate.js",
    "plate_handles.js",
    "preview.js",
    "profile_history.js",
    "reports.js",
    "rewind.js",
    "router.js",
    "saving.js",
    "schema.js",
    "screen.js",
    "settings.js",
    "sheet.js",
    "socket.js",
    "status.js",
    "style.css",
    "templates.js",
    "text.js",
    "trace.js",
    "values.js",
    "words.js",
];

/// Answers `GET /`.
pub(super) async fn index() -> Response {
    found("index.html")
}

/// Answers `GET /page/NAME`.
pub(super) async fn file(Path(name): Path<String>) -> Response {
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
    use super::*;

    #[test]
    fn every_file_of_the_folder_is_served_with_its_kind() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/src/dashboard/page");
        let entries = std::fs::read_dir(folder).unwrap().map(Result::unwrap);
        let mut names: Vec<_> = entries.map(|entry| entry.file_name().into_string().unwrap()).collect();
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
}
