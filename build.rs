//! Tells the program what built it: the compiler, the profile, the processor that it is for, and in release builds the commit. A measurement without
//! them cannot be repeated.

use std::env;
use std::path::Path;
use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let compiler = env::var("RUSTC").unwrap_or_else(|_| "rustc".to_owned());
    let version = output(&compiler, &["--version"]).unwrap_or_else(|| "an unknown compiler".to_owned());
    println!("cargo::rustc-env=WAVETRACE_COMPILER={version}");
    let profile = env::var("PROFILE").unwrap_or_default();
    println!("cargo::rustc-env=WAVETRACE_PROFILE={profile}");
    println!("cargo::rustc-env=WAVETRACE_TARGET={}", target());
    // Other builds would begin anew after each commit.
    if profile == "release" {
        println!("cargo::rustc-env=WAVETRACE_COMMIT={}", commit().unwrap_or_default());
    }
}

/// The processor that the code is for, by what kernels gain from: the level of x86-64, and instructions on fields of bits.
fn target() -> String {
    let [arch, features] =
        ["CARGO_CFG_TARGET_ARCH", "CARGO_CFG_TARGET_FEATURE"].map(|name| env::var(name).unwrap_or_default());
    let has = |all: &[&str]| all.iter().all(|name| features.split(',').any(|feature| feature == *name));
    let level = match arch.as_str() {
        "x86_64" if has(&["avx512f", "avx512bw", "avx512dq", "avx512vl"]) => "x86-64-v4",
        "x86_64" if has(&["avx2", "bmi2", "fma"]) => "x86-64-v3",
        "x86_64" if has(&["sse4.2", "popcnt"]) => "x86-64-v2",
        "x86_64" => "x86-64",
        other => other,
    };
    format!("{level}{}", if has(&["gfni"]) { "+gfni" } else { "" })
}

/// The commit of this checkout, with a plus sign where files differ from it; none outside a checkout.
fn commit() -> Option<String> {
    // A folder above may be a checkout of something else.
    let top = output("git", &["rev-parse", "--show-toplevel"])?;
    if Path::new(&top).canonicalize().ok()? != env::current_dir().ok()?.canonicalize().ok()? {
        return None;
    }
    let log = output("git", &["rev-parse", "--git-path", "logs/HEAD"])?;
    for path in [log.as_str(), "src", "Cargo.toml", "Cargo.lock"] {
        if Path::new(path).exists() {
            println!("cargo::rerun-if-changed={path}");
        }
    }
    let commit = output("git", &["rev-parse", "--short=12", "HEAD"])?;
    let changed = output("git", &["status", "--porcelain", "--untracked-files=no"]).is_none_or(|text| !text.is_empty());
    Some(format!("{commit}{}", if changed { "+" } else { "" }))
}

fn output(program: &str, args: &[&str]) -> Option<String> {
    let output = Command::new(program).args(args).output().ok().filter(|output| output.status.success())?;
    Some(String::from_utf8(output.stdout).ok()?.trim().to_owned())
}
