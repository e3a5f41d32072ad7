//! Tells the program what built it: the compiler, the profile, and in release builds the commit. A measurement without
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
    // Other builds would begin anew after each commit.
    if profile == "release" {
        println!("cargo::rustc-env=WAVETRACE_COMMIT={}", commit().unwrap_or_default());
    }
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
