//! `firmware-proto` as a static library without a standard library: it needs nothing but memory functions, cannot
//! panic, and C can call it.

#[cfg(test)]
mod tests {
    use std::path::{Path, PathBuf};
    use std::process::Command;

    use crate::c_compiler::compile;
    use crate::support::require;

    /// What a compiler may ask of any environment, a bare one included.
    const ALLOWED: &[&str] = &["bcmp", "memcmp", "memcpy", "memmove", "memset"];

    const ENTRY_POINTS: &[&str] = &[
        "tactpad_crate_decode_report",
        "tactpad_crate_receive",
        "tactpad_crate_receiver_len",
        "tactpad_crate_receiver_reset",
        "tactpad_encode_acknowledgement",
        "tactpad_encode_identity",
        "tactpad_encode_sample",
        "tactpad_report_acknowledgement",
        "tactpad_report_identity",
        "tactpad_report_sample",
    ];

    fn run(command: &mut Command) -> String {
        let output = command.output().unwrap();
        assert!(output.status.success(), "{command:?}: {}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    }

    /// Builds the static library.
    fn library() -> PathBuf {
        let target = Path::new(env!("CARGO_TARGET_TMPDIR")).join("nostd");
        let manifest = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/nostd/Cargo.toml");
        let mut cargo = Command::new(env!("CARGO"));
        cargo
            .args(["build", "--release", "--offline", "--locked", "--quiet", "--manifest-path"])
            .arg(manifest);
        run(cargo.arg("--target-dir").arg(&target).env_remove("CARGO_BUILD_TARGET"));
        target.join("release/libnostd.a")
    }

    /// Links the entry points and whatever they need to one object; the names that are still undefined.
    fn undefined(library: &Path) -> Vec<String> {
        let object = library.with_file_name("linked.o");
        let mut ld = Command::new("ld");
        ld.args(["-r", "--gc-sections"]);
        ld.args(ENTRY_POINTS.iter().flat_map(|name| ["-u", name]));
        run(ld.arg("-o").arg(&object).arg(library));
        let defined = run(Command::new("nm").args(["--defined-only", "--format=just-symbols"]).arg(&object));
        for name in ENTRY_POINTS {
            assert!(defined.lines().any(|line| line == *name), "{name} was not linked");
        }
        let undefined =
            run(Command::new("nm").args(["--undefined-only", "--format=just-symbols"]).arg(&object));
        undefined.lines().map(str::to_owned).collect()
    }

    #[test]
    fn it_needs_nothing_but_memory_functions() {
        if !require("ld", "apt-get install binutils") {
            return;
        }
        // A panic that could happen would show here too: the library's panic handler calls what does not exist.
        let undefined = undefined(&library());
        assert!(undefined.iter().all(|name| ALLOWED.contains(&name.as_str())), "{undefined:?}");
    }

    #[test]
    fn c_can_call_it() {
        let library = library();
        let sources = ["tests/nostd/caller.c", library.to_str().unwrap()];
        let Some(caller) = compile("nostd-caller", &sources, &["-Os"]) else { return };
        let example = include_str!("../../firmware-proto/vectors/samples.txt");
        let said = run(&mut Command::new(caller));
        let lines: Vec<&str> = said.lines().map(str::trim).collect();
        let frame = lines[0].split_whitespace().collect::<String>();
        let example: String = example.split_whitespace().collect();
        assert!(frame.len() == 120 && example.contains(&frame), "{frame}");
        // Damaged, and then a command: set rate, 1000.
        assert_eq!(lines[1..], ["2 00 0", "1 82 1000"]);
    }
}
