//! Dependencies in `Cargo.lock`, tested without tools or network. `deny.toml` has the remaining
//! rules.

use std::collections::BTreeMap;
use std::path::Path;

/// Crates with two versions, required by other crates. The list may shrink but not grow.
const TWICE: [&str; 22] = [
    "calloop",
    "calloop-wayland-source",
    "foldhash",
    "getrandom",
    "hashbrown",
    "linux-raw-sys",
    "miniz_oxide",
    "rustix",
    "smithay-client-toolkit",
    "syn",
    "thiserror",
    "thiserror-impl",
    "bitflags",
    "glam",
    "jni-sys",
    "r-efi",
    "redox_syscall",
    "rustc-hash",
    "objc2-app-kit",
    "objc2-foundation",
    "objc2",
    "block2",
];

/// Banned crates: C code that decodes files (except SQLite, see `deny.toml`), network access, and
/// unmaintained code.
const UNWANTED: [&str; 7] =
    ["openssl-sys", "libwebp-sys", "curl-sys", "reqwest", "hyper", "roxmltree", "ttf-parser"];

/// Returns `name version source` of every package.
fn packages() -> Vec<[String; 3]> {
    let lock = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.lock")).unwrap();
    let field = |block: &str, name: &str| {
        let line = block.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(" = "));
        line.unwrap_or("").trim_matches('"').to_owned()
    };
    lock.split("[[package]]")
        .skip(1)
        .map(|block| ["name", "version", "source"].map(|name| field(block, name)))
        .collect()
}

#[test]
fn come_from_the_registry_alone() {
    let foreign: Vec<_> = packages()
        .into_iter()
        .filter(|[name, _, source]| {
            !["epiline", "epiline-lab", "epiline-python"].contains(&&**name)
                && source != "registry+https://github.com/rust-lang/crates.io-index"
        })
        .collect();
    assert!(foreign.is_empty(), "{foreign:?}");
}

#[test]
fn are_there_once_and_none_is_unwanted() {
    let mut versions: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for [name, version, _] in packages() {
        assert!(!UNWANTED.contains(&&*name), "{name} is back");
        versions.entry(name).or_default().push(version);
    }
    let is_system = |name: &str| name.starts_with("windows") || name.starts_with("objc2");
    let twice: Vec<_> = versions
        .iter()
        .filter(|(name, versions)| versions.len() > 1 && !TWICE.contains(&&***name) && !is_system(name))
        .collect();
    assert!(twice.is_empty(), "more than one version of {twice:?}");
}
