//! `tactpad adapt --play`: a decoder from a capture of play and a known weight, and what is refused.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::fs;
use std::path::Path;

use crate::ran::{json, printed, refused};

/// Other gains, noise that lasts, a finger that is not still: faults that need no field of their own.
const PAD: &str = "[noise]\nadditive_uv = 10.0\nshare = 0.02\nshare_time_s = 3.0\n[finger]\nwander_mm = 0.3\nwander_time_s = 0.1\n\
                   [[module]]\nindex = 0\ngain = [1.3, 1.2, 0.9]\n[[module]]\nindex = 1\ngain = [1.2, 1.4, 1.1]\n\
                   [[module]]\nindex = 2\ngain = [1.35, 1.25, 1.0]\n";

/// A minute of play and five placements of 200 g.
fn played(folder: &Path) {
    fs::write(folder.join("pad.toml"), PAD).unwrap();
    json(
        folder,
        "twin --imperfections pad.toml --plan presses --seconds 60 --weight-g 200 --weights w.csv --out game.cap --json",
    );
}

/// Errors against the truth on contacts that were not seen: mm and N.
fn errors(folder: &Path, decoder: &str) -> [f64; 2] {
    let found = json(folder, &format!("evaluate --decoder {decoder} --measured m.csv --truth t.csv --json"));
    ["position_mae_mm", "force_mae_n"].map(|name| found["truth"][name].as_f64().unwrap())
}

#[test]
fn a_pad_is_calibrated_by_play_and_a_weight() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    played(folder);
    json(
        folder,
        "twin --imperfections pad.toml --plan recommended --seed 5 --out m.csv --truth t.csv --json",
    );
    let found = json(folder, "adapt --play game.cap --weights w.csv --out home.decoder --json");
    assert_eq!((&found["placements"], &found["scale_known"]), (&5.into(), &true.into()));
    assert!(found["presses"].as_u64().unwrap() > 100, "{found}");
    assert_eq!(found["map"].as_array().unwrap().len(), 13);
    assert_eq!(found["warnings"], serde_json::json!([]), "its modules are where pads have theirs");
    let gain: Vec<f64> =
        found["pad"]["gain"].as_array().unwrap().iter().map(|it| it.as_f64().unwrap()).collect();
    let truth = [1.3, 1.2, 0.9, 1.2, 1.4, 1.1, 1.35, 1.25, 1.0];
    assert!(gain.iter().zip(truth).all(|(found, truth)| (found / truth - 1.0).abs() < 0.08), "{gain:?}");
    let [mm, n] = errors(folder, "home.decoder");
    let [nominal_mm, nominal_n] = errors(folder, "inverse");
    assert!(mm < 0.5 * nominal_mm && n < 0.25 * nominal_n, "{mm} {n} of {nominal_mm} {nominal_n}");
}

#[test]
fn without_a_weight_the_scale_is_said_to_be_unknown() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    played(folder);
    let said = printed(folder, "adapt --play game.cap --out home.decoder");
    assert!(said.contains("The force's scale is unknown") && said.contains("--weights"), "{said}");
    assert!(said.contains("0 placements of a weight") && said.contains("home.decoder is written"), "{said}");
}

#[test]
fn what_is_no_play_is_refused_in_a_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("pad.toml"), PAD).unwrap();
    json(
        folder,
        "twin --imperfections pad.toml --plan play --seconds 5 --within-mm 5 --out short.cap --json",
    );
    let line = "adapt --play short.cap --weights w.csv --out home.decoder";
    for (weights, said) in [
        ("t_s,x,y\n", "w.csv: line 1: the first line must be t_s,x_mm,y_mm,weight_g"),
        ("t_s,x_mm,y_mm,weight_g\n1,0,0,heavy\n", "w.csv: line 2: write four numbers"),
        ("t_s,x_mm,y_mm,weight_g\n1,0,0,5\n", "w.csv: line 2: 5 g is no weight for this pad"),
        ("t_s,x_mm,y_mm,weight_g\n0.3,0,0,200\n", "w.csv: line 2: nothing lies on the pad at 0.3 s"),
    ] {
        fs::write(folder.join("w.csv"), weights).unwrap();
        let told = refused(folder, line);
        assert!(told.contains(said), "{told}");
    }
    for (line, said) in [
        ("adapt --play short.cap --measured pad.toml --out a", "cannot be used with"),
        ("adapt --play short.cap --method knn --out a", "only --method inverse"),
        ("adapt --weights w.csv --out a", "--play"),
        ("adapt --play short.cap --out short.cap", "is the capture"),
        ("adapt --play pad.toml --out a", "pad.toml"),
        ("adapt --out a", "--method"),
    ] {
        let told = refused(folder, line);
        assert!(told.contains(said), "{line}: {told}");
    }
    assert!(!folder.join("home.decoder").exists() && !folder.join("a").exists());
}
