//! Reports of diagnoses are opened from a list.

use std::fs;

use crate::browser::Browser;
use crate::shown::Shown;

#[test]
fn what_diagnose_has_written_is_listed_and_opened_and_nothing_else() {
    let shown = Shown::start("virtual", "contra");
    let folder = shown.running.folder.path();
    for (name, found) in [("first", "module_rotated"), ("second", "creep")] {
        let report = folder.join(name);
        fs::create_dir_all(&report).unwrap();
        fs::write(report.join("report.html"), format!("<!doctype html><title>{found}</title><p>{found}</p>"))
            .unwrap();
        let document =
            serde_json::json!({"verdict": "explained", "findings": [{"effect": found, "target": "module1"}]});
        fs::write(report.join("report.json"), document.to_string()).unwrap();
    }
    fs::create_dir_all(folder.join("tactpad")).unwrap();
    let [first, gone, second] =
        ["first", "gone", "second"].map(|name| folder.join(name).display().to_string());
    fs::write(folder.join("tactpad/reports"), format!("{first}\n{gone}\n{second}\n")).unwrap();
    let listed = shown.ask("GET /api/reports", "").json();
    let names: Vec<_> =
        listed["reports"].as_array().unwrap().iter().map(|it| it["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["second", "first"]);
    assert_eq!(listed["reports"][0]["summary"], "creep of module1");
    let page = shown.ask("GET /report/2", "");
    assert!(String::from_utf8_lossy(&page.body).contains("<p>creep</p>"), "{page:?}");
    assert!(
        page.head.iter().any(|line| line.starts_with("content-security-policy") && line.contains("sandbox")),
        "{page:?}"
    );
    for id in ["1", "3", "x", "..%2F0", "-1"] {
        assert_eq!(shown.ask(&format!("GET /report/{id}"), "").status, 404, "{id}");
    }
    let Some(browser) = Browser::open(&shown.url) else { return };
    browser.view("reports");
    browser.wait("document.querySelectorAll('#reports a').length === 2");
    let address = browser.run("return document.querySelector('#reports a').href");
    assert!(address.as_str().is_some_and(|it| it.contains("/report/2?token=")), "{address}");
}
