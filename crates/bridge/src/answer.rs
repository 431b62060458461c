//! Answers of the bridge, each a line of JSON.

/// It was done.
pub(super) fn done() -> String {
    r#"{"ok":true}"#.into()
}

/// Why it was not done, for people.
pub(super) fn refused(error: &str) -> String {
    serde_json::json!({"ok": false, "error": error}).to_string()
}

/// Where the page is, as an answer.
pub(super) fn page(url: Option<String>) -> String {
    url.map_or_else(
        || refused("this bridge shows no page: start it with --dashboard"),
        |url| serde_json::json!({"ok": true, "url": url}).to_string(),
    )
}

/// Which weighing has begun, as an answer.
pub(super) fn weighing(number: u64) -> String {
    serde_json::json!({"ok": true, "weighing": number}).to_string()
}
