//! Makes constants of the numbers of the statics decoder, whose home is models/statics.toml.

use std::path::Path;
use std::{env, fs};

const FILE: &str = "../../../models/statics.toml";

const NUMBERS: [&str; 6] = [
    "tangential_uv_per_n",
    "radial_uv_per_n",
    "normal_uv_per_n",
    "contact_height_mm",
    "false_shear_per_mm",
    "module_radius_mm",
];

fn main() {
    println!("cargo:rerun-if-changed={FILE}");
    let text = fs::read_to_string(FILE).unwrap_or_default();
    let constant = |name: &&str| {
        let value = text.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(" = "));
        let value = value.and_then(|value| value.parse::<f64>().ok());
        assert!(value.is_some(), "{FILE} has no number {name}");
        let value = value.unwrap_or_default();
        format!("/// `{name}`.\npub(super) const {}: f64 = {value:?};\n", name.to_uppercase())
    };
    let out = env::var("OUT_DIR").unwrap_or_default();
    let constants = NUMBERS.iter().map(constant).collect::<String>();
    let written = fs::write(Path::new(&out).join("statics.rs"), constants);
    assert!(written.is_ok(), "the constants cannot be written to {out}: {written:?}");
}
