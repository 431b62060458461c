//! Tells the linker where the chip's memory lies.

use std::path::Path;
use std::{env, fs};

fn main() {
    let out = env::var("OUT_DIR").unwrap_or_default();
    let copied = fs::copy("memory.x", Path::new(&out).join("memory.x"));
    assert!(copied.is_ok(), "memory.x cannot be copied to {out}: {copied:?}");
    println!("cargo:rerun-if-changed=memory.x");
    println!("cargo:rustc-link-search={out}");
    for argument in ["--nmagic", "-Tlink.x"] {
        println!("cargo:rustc-link-arg-bins={argument}");
    }
}
