//! What the program is built from: where each crate comes from, and by which licence it may be shipped.

use std::process::Command;

use serde_json::Value;
use spdx::{Expression, ParseMode};

use super::root;

/// Where crates come from.
const REGISTRY: &str = "registry+https://github.com/rust-lang/crates.io-index";

/// Licences that ask for nothing but that their text goes along.
const PERMISSIVE: [&str; 9] =
    ["0BSD", "Apache-2.0", "BSD-2-Clause", "BSD-3-Clause", "ISC", "MIT", "Unicode-3.0", "Unlicense", "Zlib"];

/// A crate that is used as its authors publish it, by a licence that asks for changes of its own files: the owner's choice.
const UNCHANGED: [(&str, &str); 1] = [("serialport", "MPL-2.0")];

/// Whether a crate may be in the program.
fn is_shippable(name: &str, licence: &str) -> bool {
    let expression = Expression::parse_mode(licence, ParseMode::LAX);
    expression.is_ok_and(|expression| {
        expression.evaluate(|required| {
            let id = required.license.id().map_or("", |id| id.name);
            PERMISSIVE.contains(&id) || UNCHANGED.contains(&(name, id))
        })
    })
}

#[test]
fn packages_are_made_by_the_same_licences() {
    let text = std::fs::read_to_string(root().join("dist/texts/about.toml")).unwrap();
    let about: toml::Table = toml::from_str(&text).unwrap();
    let mut accepted: Vec<&str> =
        about["accepted"].as_array().unwrap().iter().filter_map(toml::Value::as_str).collect();
    let mut known: Vec<&str> = UNCHANGED.iter().map(|(_, licence)| *licence).chain(PERMISSIVE).collect();
    accepted.sort_unstable();
    known.sort_unstable();
    assert_eq!(accepted, known);
}

#[test]
fn each_crate_is_of_the_registry_and_may_be_shipped() {
    let mut cargo = Command::new(env!("CARGO"));
    cargo.current_dir(root()).args(["metadata", "--locked", "--format-version", "1"]);
    // What other systems need was not fetched.
    cargo.args(["--filter-platform", &format!("{}-unknown-linux-gnu", std::env::consts::ARCH)]);
    let said = cargo.output().unwrap();
    assert!(said.status.success(), "{}", String::from_utf8_lossy(&said.stderr));
    let metadata: Value = serde_json::from_slice(&said.stdout).unwrap();
    let packages = metadata["packages"].as_array().unwrap();
    assert!(packages.len() > 100, "only {} crates", packages.len());
    let text = |package: &Value, key: &str| package[key].as_str().unwrap_or_default().to_owned();
    let wrong: Vec<String> = packages
        .iter()
        .filter(|package| {
            let is_ours = package["source"].is_null();
            let is_of_registry = is_ours || package["source"] == REGISTRY;
            !is_of_registry || !is_shippable(&text(package, "name"), &text(package, "license"))
        })
        .map(|package| ["name", "license", "source"].map(|key| text(package, key)).join(", "))
        .collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn a_licence_is_read_as_it_is_meant() {
    for licence in
        ["MIT/Apache-2.0", "(MIT OR GPL-3.0-only) AND Unicode-3.0", "Apache-2.0 WITH LLVM-exception OR MIT"]
    {
        assert!(is_shippable("any", licence), "{licence}");
    }
    for licence in ["", "GPL-3.0-only", "MIT AND LGPL-2.1-or-later", "MPL-2.0", "no licence"] {
        assert!(!is_shippable("any", licence), "{licence}");
    }
    assert!(is_shippable("serialport", "MPL-2.0"));
}
