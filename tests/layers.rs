//! The architecture holds: imports point down only, each foreign library is named in one place, files stay short, the
//! library neither prints nor exits. The source text is read; comments, strings and unit tests count nothing.

mod common;

use common::meshes::repository;
use std::fs;
use std::path::Path;

/// Top modules by layer; a module may use those of lower layers and its own.
const LAYERS: &[(&str, u32)] = &[
    ("lanes", 0),
    ("columns", 0),
    ("linear", 0),
    ("ids", 0),
    ("error", 0),
    ("input", 0),
    ("probe", 0),
    ("sampling", 1),
    ("film", 1),
    ("material", 2),
    ("light", 2),
    ("camera", 2),
    ("world", 3),
    ("accel", 4),
    ("wave", 5),
    ("render", 6),
    ("scene", 7),
    ("output", 7),
    ("report", 7),
    ("bench", 8),
    ("chart", 8),
    ("cli", 9),
    ("main", 10),
    ("lib", 10),
];

/// Imports against the order that stand for now, each with its reason: none.
const EXCEPTIONS: &[(&str, &str)] = &[];

/// Finer than the layers: what each of these may use within its own layer or at all.
const ONLY: &[(&str, &[&str])] = &[
    ("accel", &["lanes", "columns", "ids", "error", "probe"]),
    ("scene", &["error", "input", "world", "camera", "linear"]),
    ("report", &["error", "film"]),
    ("chart", &["lanes", "error", "input", "film", "render", "output", "report"]),
    (
        "bench",
        &[
            "lanes", "columns", "linear", "error", "input", "probe", "sampling", "world", "accel", "render", "scene",
            "output",
        ],
    ),
];

/// Libraries, and the only places that may name them.
const LIBRARIES: &[(&str, &[&str])] = &[
    ("wide", &["lanes/"]),
    ("glam", &["linear.rs"]),
    ("obvhs", &["accel/build.rs"]),
    ("memmap2", &["accel/arena.rs"]),
    ("tobj", &["scene/obj.rs"]),
    ("rayon", &["render/schedule.rs", "accel/parallel.rs"]),
    ("rustix", &["bench/cpu.rs"]),
    ("perf_event", &["probe/counters.rs"]),
    ("serde_json", &["scene/", "chart/", "cli/"]),
    ("csv", &["chart/row.rs"]),
    ("resvg", &["chart/raster.rs"]),
    ("dejavu", &["chart/raster.rs"]),
    ("base64", &["chart/gallery.rs"]),
    ("sysinfo", &["chart/machine.rs"]),
    ("image", &["output/"]),
    ("exr", &["output/"]),
    ("png", &["output/"]),
    ("rand_xoshiro", &["sampling/xoshiro.rs"]),
    // Of material/mod.rs its test module alone.
    ("statrs", &["report/student.rs", "material/mod.rs"]),
    ("colorous", &["report/heatmap.rs"]),
    ("clap", &["cli/", "main.rs"]),
    ("indicatif", &["cli/"]),
    ("ctrlc", &["cli/"]),
];

/// Top modules whose inner loops are reached statically.
const STATIC_UP_TO: u32 = 5;
/// Files that may say `unsafe`: SIMD that is chosen when the program runs.
const UNSAFE: &[&str] = &["lanes/avx2.rs", "lanes/dispatch.rs", "lanes/prefetch.rs"];
/// Lines of a file before its unit tests.
const LONGEST: usize = 300;

/// Source text without comments, strings, characters, and what follows `#[cfg(test)]`.
fn code(text: &str) -> String {
    let text = text.split("\n#[cfg(test)]\nmod tests").next().unwrap_or(text);
    let chars: Vec<char> = text.chars().collect();
    let (mut out, mut i) = (String::new(), 0);
    let at = |i: usize| chars.get(i).copied().unwrap_or('\0');
    while i < chars.len() {
        match at(i) {
            '/' if at(i + 1) == '/' => {
                while i < chars.len() && at(i) != '\n' {
                    i += 1;
                }
            }
            '/' if at(i + 1) == '*' => {
                let mut depth = 0;
                loop {
                    match (at(i), at(i + 1)) {
                        ('/', '*') => (depth, i) = (depth + 1, i + 2),
                        ('*', '/') => (depth, i) = (depth - 1, i + 2),
                        _ => i += 1,
                    }
                    if depth == 0 || i >= chars.len() {
                        break;
                    }
                }
            }
            'r' if (at(i + 1) == '"' || at(i + 1) == '#') && raw_string(&chars, i).is_some() => {
                i = raw_string(&chars, i).unwrap_or(i + 1);
                out.push_str("\"\"");
            }
            '"' => {
                i += 1;
                while i < chars.len() && at(i) != '"' {
                    i += if at(i) == '\\' { 2 } else { 1 };
                }
                i += 1;
                out.push_str("\"\"");
            }
            // A character, not a lifetime.
            '\'' if at(i + 1) == '\\' || at(i + 2) == '\'' => {
                i += if at(i + 1) == '\\' { 3 } else { 2 };
                while i < chars.len() && at(i) != '\'' {
                    i += 1;
                }
                i += 1;
            }
            c => {
                out.push(c);
                i += 1;
            }
        }
    }
    out
}

/// Where the raw string that begins at `i` ends, if one does.
fn raw_string(chars: &[char], i: usize) -> Option<usize> {
    if i > 0 && (chars[i - 1].is_alphanumeric() || chars[i - 1] == '_') {
        return None;
    }
    let hashes = chars[i + 1..].iter().take_while(|&&c| c == '#').count();
    let open = i + 1 + hashes;
    if chars.get(open) != Some(&'"') {
        return None;
    }
    (open + 1..chars.len())
        .find(|&k| chars[k] == '"' && chars[k + 1..].iter().take(hashes).filter(|&&c| c == '#').count() == hashes)
        .map(|k| k + 1 + hashes)
}

/// Words and the punctuation that matters: `::`, `{`, `}`, `,`, the rest as single characters.
fn tokens(code: &str) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    let mut chars = code.chars().peekable();
    while let Some(c) = chars.next() {
        if c.is_alphanumeric() || c == '_' {
            let mut word = c.to_string();
            while let Some(&d) = chars.peek().filter(|d| d.is_alphanumeric() || **d == '_') {
                word.push(d);
                chars.next();
            }
            out.push(word);
        } else if c == ':' && chars.peek() == Some(&':') {
            chars.next();
            out.push("::".into());
        } else if !c.is_whitespace() {
            out.push(c.into());
        }
    }
    out
}

/// Top modules that follow `crate::`, also within braces.
fn imports(tokens: &[String]) -> Vec<String> {
    let is = |i: usize, t: &str| tokens.get(i).is_some_and(|x| x == t);
    let mut found = Vec::new();
    for i in 0..tokens.len() {
        if !((is(i, "crate") || is(i, "wavetrace")) && is(i + 1, "::")) {
            continue;
        }
        if !is(i + 2, "{") {
            found.extend(tokens.get(i + 2).cloned());
            continue;
        }
        let (mut depth, mut k) = (1, i + 3);
        let mut first = true;
        while depth > 0 && k < tokens.len() {
            match tokens[k].as_str() {
                "{" => depth += 1,
                "}" => depth -= 1,
                "," if depth == 1 => first = true,
                word if depth == 1 && first => {
                    found.push(word.into());
                    first = false;
                }
                _ => {}
            }
            k += 1;
        }
    }
    found.retain(|m| m.chars().next().is_some_and(char::is_alphabetic));
    found
}

fn layer(module: &str) -> Option<u32> {
    LAYERS.iter().find(|l| l.0 == module).map(|l| l.1)
}

/// What is wrong with the file at `path` below `src`.
fn faults(path: &str, text: &str) -> Vec<String> {
    let mut out = Vec::new();
    let code = code(text);
    let tokens = tokens(&code);
    let module = path.split('/').next().unwrap_or(path).trim_end_matches(".rs");
    let is = |i: usize, t: &str| tokens.get(i).is_some_and(|x| x == t);
    let Some(own) = layer(module) else { return vec![format!("{path}: the module {module} has no layer")] };
    for import in imports(&tokens) {
        // A macro or a re-export at the root, such as a type of the API, has no layer; modules all have one.
        let Some(other) = layer(&import) else {
            if !import.starts_with(char::is_uppercase) {
                out.push(format!("{path}: uses crate::{import}, which has no layer"));
            }
            continue;
        };
        let allowed = ONLY.iter().find(|o| o.0 == module).is_none_or(|o| o.1.contains(&import.as_str()));
        let down = other < own || (other == own && own < 7);
        if import != module && !(down && allowed) && !EXCEPTIONS.contains(&(module, import.as_str())) {
            out.push(format!("{path}: uses {import} (layer {other}) from layer {own}"));
        }
    }
    for &(library, places) in LIBRARIES {
        let word = |i: usize| tokens[i].starts_with(|c: char| c.is_alphabetic()) && !is(i, "use");
        let within_path = |i: usize| i > 1 && (is(i - 1, ".") || (is(i - 1, "::") && word(i - 2)));
        let named = (0..tokens.len())
            .any(|i| is(i, library) && !within_path(i) && (is(i + 1, "::") || (i > 0 && is(i - 1, "use"))));
        if named && !places.iter().any(|p| path == *p || (p.ends_with('/') && path.starts_with(p))) {
            out.push(format!("{path}: names the library {library}"));
        }
    }
    if own <= STATIC_UP_TO && tokens.iter().any(|t| t == "dyn") {
        out.push(format!("{path}: uses dyn"));
    }
    if tokens.iter().any(|t| t == "unsafe") && !UNSAFE.contains(&path) {
        out.push(format!("{path}: uses unsafe"));
    }
    let lines = text.split("\n#[cfg(test)]\nmod tests").next().unwrap_or(text).lines().count();
    if lines > LONGEST {
        out.push(format!("{path}: {lines} lines before its tests"));
    }
    // The command line prints, and its main function ends the process.
    if !["main", "cli"].contains(&module) {
        for (i, word) in tokens.iter().enumerate() {
            let prints = ["println", "eprintln", "print", "eprint", "dbg"].contains(&word.as_str()) && is(i + 1, "!");
            let exits = word == "process" && is(i + 1, "::") && (is(i + 2, "exit") || is(i + 2, "abort"));
            if prints || exits {
                out.push(format!("{path}: the library prints or exits ({word})"));
            }
        }
    }
    out
}

fn visit(folder: &Path, root: &Path, found: &mut Vec<(String, String)>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            visit(&path, root, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            let name = path.strip_prefix(root).unwrap().to_str().unwrap().replace('\\', "/");
            found.push((name, fs::read_to_string(&path).unwrap()));
        }
    }
}

#[test]
fn the_source_keeps_to_its_layers() {
    let (root, mut files) = (repository("src"), Vec::new());
    visit(&root, &root, &mut files);
    assert!(files.len() > 40, "only {} files were found", files.len());
    let all: Vec<String> = files.iter().flat_map(|(path, text)| faults(path, text)).collect();
    assert!(all.is_empty(), "{}", all.join("\n"));
}

/// The checker finds what it is there to find.
#[test]
fn bad_files_are_found() {
    for (path, text, fault) in [
        ("lanes/mod.rs", "use crate::world::World;", "uses world (layer 3) from layer 0"),
        ("accel/x.rs", "use crate::world::World;", "uses world (layer 3) from layer 4"),
        ("wave/x.rs", "use crate::{lanes::Vec3, render::Settings};", "uses render (layer 6) from layer 5"),
        ("wave/x.rs", "use crate::{lanes::{a, b}, scene};", "uses scene (layer 7) from layer 5"),
        ("wave/x.rs", "fn f() { crate::output::write() }", "uses output (layer 7) from layer 5"),
        ("scene/x.rs", "use crate::output::Image;", "uses output (layer 7) from layer 7"),
        ("chart/x.rs", "use crate::bench::Tracer;", "uses bench (layer 8) from layer 8"),
        ("chart/page.rs", "use csv::Reader;", "names the library csv"),
        ("bench/x.rs", "use crate::wave::Wave;", "uses wave (layer 5) from layer 8"),
        ("render/x.rs", "use crate::bench::Tracer;", "uses bench (layer 8) from layer 6"),
        ("film.rs", "pub fn f(w: &crate::wave::Job) {}", "uses wave (layer 5) from layer 1"),
        ("wave/x.rs", "use crate::novelty::X;", "uses crate::novelty, which has no layer"),
        ("novelty/x.rs", "", "the module novelty has no layer"),
        ("wave/x.rs", "use wide::f32x8;", "names the library wide"),
        ("wave/x.rs", "let r = rayon::join(a, b);", "names the library rayon"),
        ("accel/mod.rs", "use obvhs;", "names the library obvhs"),
        ("render/mod.rs", "use ::image::Rgb;", "names the library image"),
        ("material/mod.rs", "fn f(m: &dyn Fn()) {}", "uses dyn"),
        ("lanes/mod.rs", "fn f() { unsafe { g() } }", "uses unsafe"),
        ("scene/mod.rs", "fn f() { println!(\"x\") }", "prints or exits"),
        ("output/mod.rs", "fn f() { std::process::exit(1) }", "prints or exits"),
        ("render/mod.rs", &"\n".repeat(301), "301 lines before its tests"),
    ] {
        let found = faults(path, text);
        assert!(found.len() == 1 && found[0].contains(fault), "{path}: {text}\n{found:?}");
    }
}

#[test]
fn good_files_pass() {
    for (path, text) in [
        ("wave/x.rs", "use crate::{lanes::Vec3, world::World};\nuse crate::accel::{Bvh, Many};"),
        ("lanes/portable.rs", "use wide::f32x8;"),
        ("lanes/avx2.rs", "fn f() { unsafe { g() } }"),
        ("wave/x.rs", "// use crate::scene; a dyn, an unsafe\n/* wide:: /* println!() */ */ fn f() {}"),
        ("wave/x.rs", "const A: &str = \"crate::scene::load, dyn\"; const B: &str = r#\"crate::scene \" dyn\"#;"),
        ("wave/x.rs", "const Q: char = '\"'; use crate::lanes::Lanes; const R: char = '\\'';"),
        ("wave/x.rs", "fn f<'a>(x: &'a str) -> &'a str { x }\n#[cfg(test)]\nmod tests {\n use crate::scene; }"),
        ("output/x.rs", "use super::image::Image; use crate::film::Film;"),
        ("render/x.rs", "let image = film.image(); image.width; self.image::<f32>();"),
        ("render/x.rs", &format!("\n#[cfg(test)]\nmod tests {{\n{}}}", "\n".repeat(1000))),
        ("main.rs", "use wavetrace::cli; fn main() { std::process::exit(1) }"),
    ] {
        assert_eq!(faults(path, text), Vec::<String>::new(), "{path}: {text}");
    }
}
