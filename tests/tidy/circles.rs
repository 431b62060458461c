//! Files that import each other: which files a source names, and which of them lead back to it.

use std::collections::{BTreeMap, BTreeSet};

/// A file's module path, as `["pad", "device", "read"]`; a `mod.rs` is its folder.
pub(crate) type Module = Vec<String>;

/// For each file, those that it names.
pub(crate) type Imports = BTreeMap<Module, BTreeSet<Module>>;

/// What each of a crate's files imports. `sources` are the files with their texts, without tests.
pub(crate) fn imports(sources: &[(Module, String)]) -> Imports {
    let files: BTreeSet<Module> = sources.iter().map(|(module, _)| module.clone()).collect();
    let of_file = |(module, code): &(Module, String)| {
        let tokens = tokens(code);
        let named = paths(&tokens).into_iter().filter_map(|path| file(module, &path, &files));
        (module.clone(), named.filter(|named| named != module).collect())
    };
    sources.iter().map(of_file).collect()
}

/// The circles: sets of files, each of which leads to all others of its set.
pub(crate) fn circles(imports: &Imports) -> BTreeSet<Vec<String>> {
    let reached: BTreeMap<&Module, BTreeSet<&Module>> =
        imports.keys().map(|module| (module, reached(imports, module))).collect();
    let circle = |module: &Module| -> Vec<String> {
        let lead_back = reached[module].iter().filter(|other| reached[**other].contains(module));
        lead_back.map(|other| other.join("::")).collect()
    };
    imports.keys().map(circle).filter(|circle| !circle.is_empty()).collect()
}

/// All files that `from` leads to; itself only by way of others.
fn reached<'i>(imports: &'i Imports, from: &Module) -> BTreeSet<&'i Module> {
    let mut reached = BTreeSet::new();
    let mut open: Vec<&Module> = imports[from].iter().collect();
    while let Some(module) = open.pop() {
        if reached.insert(module) {
            open.extend(&imports[module]);
        }
    }
    reached
}

/// The file that a path inside `module` leads into: the longest part of the path that is a file.
fn file(module: &Module, path: &[&str], files: &BTreeSet<Module>) -> Option<Module> {
    let (first, rest) = path.split_first()?;
    let mut whole = match *first {
        "crate" => Vec::new(),
        "self" => module.clone(),
        "super" => parent(module),
        // A child, declared here and used bare.
        child => [module.as_slice(), &[child.to_owned()]].concat(),
    };
    if !["crate", "self", "super"].contains(first) && !files.contains(&whole) {
        return None;
    }
    for name in rest {
        if *name == "super" { whole = parent(&whole) } else { whole.push((*name).to_owned()) }
    }
    while !whole.is_empty() && !files.contains(&whole) {
        whole.pop();
    }
    files.contains(&whole).then_some(whole)
}

fn parent(module: &Module) -> Module {
    module.split_last().map_or_else(Vec::new, |(_, parent)| parent.to_vec())
}

/// All paths of two names or more: those of uses, with their braces opened, and those inside the code.
fn paths<'c>(tokens: &[&'c str]) -> Vec<Vec<&'c str>> {
    let mut found = Vec::new();
    let mut at = 0;
    while at < tokens.len() {
        let begins = is_name(tokens[at]) && tokens.get(at + 1) == Some(&"::");
        at = if begins { path(tokens, at, Vec::new(), &mut found) } else { at + 1 };
    }
    found
}

/// Adds what follows `prefix` to the found paths, and says where it ends.
fn path<'c>(
    tokens: &[&'c str],
    mut at: usize,
    mut prefix: Vec<&'c str>,
    found: &mut Vec<Vec<&'c str>>,
) -> usize {
    while let Some(token) = tokens.get(at) {
        if *token == "{" && !prefix.is_empty() {
            return group(tokens, at + 1, &prefix, found);
        }
        if !is_name(token) {
            break;
        }
        // The prefix itself, as in `use super::{self, other}`.
        if *token != "self" || prefix.is_empty() {
            prefix.push(token);
        }
        at += 1;
        if tokens.get(at) != Some(&"::") {
            break;
        }
        at += 1;
    }
    found.push(prefix);
    at
}

/// The members of a brace after `prefix`.
fn group<'c>(tokens: &[&'c str], mut at: usize, prefix: &[&'c str], found: &mut Vec<Vec<&'c str>>) -> usize {
    while at < tokens.len() && tokens[at] != "}" {
        let is_member = is_name(tokens[at]) || tokens[at] == "*";
        at = if is_member { path(tokens, at, prefix.to_vec(), found).max(at + 1) } else { at + 1 };
    }
    at + 1
}

fn is_name(token: &str) -> bool {
    token.starts_with(|first: char| first.is_alphabetic() || first == '_')
}

/// Names, `::` and single characters; comments and blanks are left out.
fn tokens(code: &str) -> Vec<&str> {
    let mut tokens = Vec::new();
    for mut rest in code.lines().map(|line| line.split("//").next().unwrap_or("").trim()) {
        while !rest.is_empty() {
            let name = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
            let other =
                if rest.starts_with("::") { 2 } else { rest.chars().next().map_or(0, char::len_utf8) };
            let (token, after) = rest.split_at(if name > 0 { name } else { other });
            tokens.push(token);
            rest = after.trim_start();
        }
    }
    tokens
}

#[test]
fn circles_are_found_by_any_spelling() {
    let source = |module: &str, code: &str| {
        let names = module.split("::").filter(|name| !name.is_empty());
        (names.map(str::to_owned).collect::<Module>(), code.to_owned())
    };
    let sources = [
        source("a", "mod b;\nmod c;\nuse self::b::{\n    Thing,\n};"),
        source("a::b", "use super::{Other, c::Third as X}; // super::d"),
        source("a::c", "fn f() -> c::d::E { d::g::<Vec<u8>>() }"),
        source("a::c::d", "use super::super::b::*;"),
        source("e", "use crate::a::b; use std::fmt;"),
        source("f", "pub mod g;\nfn f() { g::h() }"),
        source("f::g", "use crate::{e, f::Thing};"),
        source("h", "mod i;\nmod j;\nuse h::i;"),
        source("h::i", "use super::{j, j::Named as _};"),
        source("h::j", "fn of(h: super::super::e::Thing) -> [u8; 3]"),
    ];
    let found = circles(&imports(&sources));
    let wanted = [vec!["a", "a::b", "a::c", "a::c::d"], vec!["f", "f::g"]];
    assert_eq!(found, wanted.map(|circle| circle.into_iter().map(str::to_owned).collect()).into());
}
