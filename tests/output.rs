//! Image files as other programs see them: decoded by independent readers, and the state of the folder afterwards.

use std::{
    fs::{self, File},
    io::BufReader,
    path::{Path, PathBuf},
};

use tempfile::TempDir;
use wavetrace::{
    error::{Error, Result},
    output::{self, Format, Image, Metadata, PARTIAL, Tone, ToneMap},
};

const ENDINGS: [&str; 4] = ["png", "ppm", "exr", "hdr"];

fn folder() -> TempDir {
    tempfile::tempdir().expect("a folder for temporary files")
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("the folder is readable");
    let mut names: Vec<_> = entries.map(|entry| entry.expect("an entry").file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

fn image(width: u32, height: u32, pixel: impl FnMut(u32) -> [f32; 3]) -> Image {
    Image { width, height, pixels: (0..width * height).map(pixel).collect() }
}

fn grey(width: u32, height: u32) -> Image {
    image(width, height, |_| [0.5; 3])
}

fn metadata(partial: bool) -> Metadata {
    let entries = [("Software", "wavetrace 0.1.0"), ("scene", "scènes/box.json"), ("spp", "16"), ("seed", "7")];
    Metadata { entries: entries.map(|(key, value)| (key.to_owned(), value.to_owned())).to_vec(), partial }
}

fn write(path: &Path, image: &Image) -> Result<()> {
    output::write(path, image, &metadata(false), &Tone::default())
}

fn read_png(path: &Path) -> (png::Info<'static>, Vec<u8>) {
    let mut reader = png::Decoder::new(BufReader::new(File::open(path).unwrap())).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut bytes).unwrap();
    reader.finish().unwrap();
    (reader.info().clone(), bytes)
}

/// Size and pixels of an EXR file, by a reader that knows nothing of the writer's layout.
fn read_exr(path: &Path) -> (u32, u32, Vec<[f32; 3]>) {
    use exr::prelude::*;
    let file = read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            |size, _| (size, vec![[0f32; 3]; size.area()]),
            |(size, pixels): &mut (Vec2<usize>, Vec<[f32; 3]>), at, (red, green, blue): (f32, f32, f32)| {
                pixels[at.y() * size.width() + at.x()] = [red, green, blue];
            },
        )
        .first_valid_layer()
        .all_attributes()
        .from_file(path)
        .unwrap();
    let (size, pixels) = file.layer_data.channel_data.pixels;
    (size.width() as u32, size.height() as u32, pixels)
}

fn read_hdr(path: &Path) -> (image::codecs::hdr::HdrMetadata, Vec<[f32; 3]>) {
    use image::ImageDecoder;
    let decoder = image::codecs::hdr::HdrDecoder::new(BufReader::new(File::open(path).unwrap())).unwrap();
    let header = decoder.metadata();
    let mut pixels = vec![[0f32; 3]; header.width as usize * header.height as usize];
    decoder.read_image(bytemuck::cast_slice_mut(&mut pixels)).unwrap();
    (header, pixels)
}

fn size_of(path: &Path) -> (u32, u32) {
    match Format::from_path(path).unwrap() {
        Format::Png => (read_png(path).0.width, read_png(path).0.height),
        Format::Ppm => image::image_dimensions(path).unwrap(),
        Format::Exr => (read_exr(path).0, read_exr(path).1),
        Format::Hdr => (read_hdr(path).0.width, read_hdr(path).0.height),
    }
}

/// IEC 61966-2-1 backwards: from encoded to linear, both in [0, 1].
fn linear(encoded: f64) -> f64 {
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

#[test]
fn png_holds_every_code_and_rounds_to_the_nearest() {
    let folder = folder();
    let path = folder.path().join("codes.png");
    // The middle of each code, and just inside its two ends.
    let at = |code: f64| linear(code.clamp(0.0, 255.0) / 255.0) as f32;
    let codes = image(256, 1, |code| [-0.4999, 0.0, 0.4999].map(|offset| at(f64::from(code) + offset)));
    write(&path, &codes).unwrap();
    let (info, bytes) = read_png(&path);
    assert_eq!((info.color_type, info.bit_depth), (png::ColorType::Rgb, png::BitDepth::Eight));
    assert!(info.srgb.is_some(), "the file says that it is sRGB");
    assert_eq!(bytes, (0..=255u8).flat_map(|code| [code; 3]).collect::<Vec<_>>());
}

#[test]
fn ppm_bytes() {
    let folder = folder();
    let path = folder.path().join("four.ppm");
    let four = Image {
        width: 2,
        height: 2,
        pixels: vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.25, 0.5, 0.001]],
    };
    let metadata = Metadata { entries: vec![("spp".to_owned(), "4".to_owned())], partial: true };
    output::write(&path, &four, &metadata, &Tone::default()).unwrap();
    let mut expected = b"P6\n# spp=4\n# wavetrace:partial=true\n2 2\n255\n".to_vec();
    expected.extend([255, 0, 0, 0, 255, 0, 0, 0, 255, 137, 188, 3]);
    assert_eq!(fs::read(&path).unwrap(), expected);
    assert_eq!(image::open(&path).unwrap().into_rgb8().into_raw(), expected[expected.len() - 12..]);
}

#[test]
fn tone_changes_8_bit_files_alone() {
    let folder = folder();
    let radiance = Image { width: 2, height: 1, pixels: vec![[4.0, 2.0, 0.0], [1.0, 0.5, 0.0]] };
    let tones = [(-1.0, ToneMap::Clamp), (0.0, ToneMap::Max)];
    let expected: [[u8; 6]; 2] = [[255, 255, 0, 188, 137, 0], [255, 188, 0, 137, 99, 0]];
    for ((exposure_ev, map), expected) in tones.into_iter().zip(expected) {
        let tone = Tone { exposure_ev, map };
        let paths = ENDINGS.map(|ending| folder.path().join("a").with_extension(ending));
        assert!(output::write_all(&paths, &radiance, &metadata(false), &tone).iter().all(Result::is_ok));
        assert_eq!(read_png(&paths[0]).1, expected, "{tone:?}");
        assert_eq!(image::open(&paths[1]).unwrap().into_rgb8().into_raw(), expected, "{tone:?}");
        assert_eq!(read_exr(&paths[2]).2, radiance.pixels, "{tone:?}");
        assert_eq!(read_hdr(&paths[3]).1, radiance.pixels, "{tone:?}");
    }
}

#[test]
fn exr_keeps_every_bit() {
    let folder = folder();
    let path = folder.path().join("floats.exr");
    let odd = [0.0, -0.0, 1.0, -1.5, f32::MIN_POSITIVE, f32::from_bits(1), f32::MAX, f32::MIN, f32::EPSILON, 1.0 / 3.0];
    let unreal = [f32::INFINITY, f32::NEG_INFINITY, f32::NAN];
    let values: Vec<f32> = odd.into_iter().chain(unreal).collect();
    // Also bit patterns without any order, and more rows than one compressed block has.
    let floats = image(13, 37, |i| {
        let i = i as usize;
        [values[i % values.len()], f32::from_bits((i as u32).wrapping_mul(2_654_435_761)), i as f32]
    });
    write(&path, &floats).unwrap();
    let (width, height, pixels) = read_exr(&path);
    assert_eq!((width, height), (13, 37));
    let bits = |pixels: &[[f32; 3]]| pixels.as_flattened().iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&pixels), bits(&floats.pixels));
}

#[test]
fn hdr_is_within_half_a_step_of_the_shared_exponent() {
    let folder = folder();
    let path = folder.path().join("range.hdr");
    // From 1e-37 to 1e37, with components of different sizes.
    let range = image(101, 7, |i| {
        let value = 10f64.powf(f64::from(i) / 706.0 * 74.0 - 37.0) as f32;
        [value, value * 0.77, value * 0.0123]
    });
    write(&path, &range).unwrap();
    let (_, pixels) = read_hdr(&path);
    for (found, expected) in pixels.iter().zip(&range.pixels) {
        // The largest mantissa is 128 or more, so that a step is at most 1/128 of it.
        let half_step = f64::from(expected[0]) / 256.0;
        for (&found, &expected) in found.iter().zip(expected) {
            assert!((f64::from(found) - f64::from(expected)).abs() <= half_step, "{expected:e} became {found:e}");
        }
    }
    // Rounding, not cutting off: the errors are centred.
    let relative = |(found, expected): (&[f32; 3], &[f32; 3])| f64::from(found[0] / expected[0]) - 1.0;
    let mean = pixels.iter().zip(&range.pixels).map(relative).sum::<f64>() / pixels.len() as f64;
    // Each error is uniform on a step of at most 1/128, so that the mean's standard deviation is at most 8.5e-5.
    // Cutting off would give -2.7e-3.
    assert!(mean.abs() < 4.0 * 8.5e-5, "mean relative error {mean:e}");
}

#[test]
fn hdr_survives_what_it_cannot_hold() {
    let folder = folder();
    let path = folder.path().join("odd.hdr");
    let odd = image(2, 1, |i| [[-1.0, f32::NAN, 0.25], [f32::INFINITY, 1e-45, f32::MAX]][i as usize]);
    write(&path, &odd).unwrap();
    let top = 255.0 * 2f32.powi(119);
    assert_eq!(read_hdr(&path).1, [[0.0, 0.0, 0.25], [top, 0.0, top]]);
}

#[test]
fn metadata_is_in_every_file() {
    let folder = folder();
    for partial in [false, true] {
        let metadata = metadata(partial);
        let mut expected = metadata.entries.clone();
        if partial {
            expected.push((PARTIAL.to_owned(), "true".to_owned()));
        }
        expected.sort();
        for ending in ENDINGS {
            let path = folder.path().join("a").with_extension(ending);
            output::write(&path, &grey(9, 2), &metadata, &Tone::default()).unwrap();
            let mut found = entries(&path);
            found.sort();
            assert_eq!(found, expected, "{ending}, partial: {partial}");
        }
    }
}

fn entries(path: &Path) -> Vec<(String, String)> {
    match Format::from_path(path).unwrap() {
        Format::Png => {
            let info = read_png(path).0;
            let ascii = info.uncompressed_latin1_text.into_iter().map(|chunk| (chunk.keyword, chunk.text));
            ascii.chain(info.utf8_text.iter().map(|c| (c.keyword.clone(), c.get_text().unwrap()))).collect()
        }
        Format::Ppm => {
            let bytes = fs::read(path).unwrap();
            let header = bytes.strip_prefix(b"P6\n").unwrap();
            let lines = header.split(|&byte| byte == b'\n').take_while(|line| line.starts_with(b"# "));
            lines.map(|line| pair(std::str::from_utf8(&line[2..]).unwrap())).collect()
        }
        Format::Exr => {
            let meta = exr::meta::MetaData::read_from_file(path, true).unwrap();
            let text = |value: &exr::prelude::AttributeValue| match value {
                exr::prelude::AttributeValue::Text(text) => String::from_utf8(text.bytes().to_vec()).unwrap(),
                other => panic!("expected text, found {other:?}"),
            };
            let header = &meta.headers[0];
            assert!(header.shared_attributes.chromaticities.is_some());
            header
                .own_attributes
                .other
                .iter()
                .chain(&header.shared_attributes.other)
                .map(|(k, v)| (k.to_string(), text(v)))
                .collect()
        }
        Format::Hdr => {
            let (header, _) = read_hdr(path);
            let own = |key: &str| !["FORMAT", "PRIMARIES"].contains(&key);
            header.custom_attributes.into_iter().filter(|(key, _)| own(key)).collect()
        }
    }
}

fn pair(line: &str) -> (String, String) {
    let (key, value) = line.split_once('=').unwrap();
    (key.to_owned(), value.to_owned())
}

#[test]
fn hostile_metadata_spoils_no_file() {
    let folder = folder();
    let keys = ["", "FORMAT", "EXPOSURE", "chunkCount", "type", "name", "a=b\n255\n", "# x", "é", &"long".repeat(99)];
    let value = "line\nFORMAT=none\n\n-Y 1 +X 1\0\u{1f600}";
    let metadata =
        Metadata { entries: keys.iter().map(|key| (key.to_string(), value.to_owned())).collect(), partial: true };
    for ending in ENDINGS {
        let path = folder.path().join("a").with_extension(ending);
        output::write(&path, &grey(9, 2), &metadata, &Tone::default()).unwrap();
        assert_eq!(size_of(&path), (9, 2), "{ending}");
        let found = entries(&path);
        assert!(found.contains(&(PARTIAL.to_owned(), "true".to_owned())), "{ending}: {found:?}");
        assert_eq!(found.len(), keys.len() + 1, "{ending}: {found:?}");
    }
    assert_eq!(read_hdr(&folder.path().join("a.hdr")).0.exposure, None);
}

#[test]
fn odd_sizes() {
    let folder = folder();
    for (width, height) in [(1, 1), (1, 65_536), (65_536, 1), (3, 7), (7, 3), (8, 1), (32_768, 2)] {
        // Counts up, so that a swapped, shifted or dropped row shows.
        let counted = image(width, height, |i| [(i % 251) as f32, (i / 251) as f32, 1.0]);
        for ending in ENDINGS {
            let path = folder.path().join("a").with_extension(ending);
            write(&path, &counted).unwrap();
            assert_eq!(size_of(&path), (width, height), "{ending}");
        }
        assert_eq!(read_exr(&folder.path().join("a.exr")).2, counted.pixels);
        let expected = Tone::default().to_srgb8(&counted);
        assert!(read_png(&folder.path().join("a.png")).1 == expected, "{width}x{height} png");
        let ppm = image::open(folder.path().join("a.ppm")).unwrap().into_rgb8().into_raw();
        assert!(ppm == expected, "{width}x{height} ppm");
        // Within half a step of the largest component.
        for (found, expected) in read_hdr(&folder.path().join("a.hdr")).1.iter().zip(&counted.pixels) {
            let largest = expected.iter().copied().fold(0.0, f32::max);
            assert!((0..3).all(|c| (found[c] - expected[c]).abs() <= largest / 256.0), "{expected:?} became {found:?}");
        }
    }
}

#[test]
fn a_flawed_image_is_refused_and_the_old_file_stays() {
    let folder = folder();
    let mut flawed = grey(4, 4);
    flawed.pixels.pop();
    for ending in ENDINGS {
        let path = folder.path().join("old").with_extension(ending);
        fs::write(&path, "precious").unwrap();
        for image in [&flawed, &grey(0, 4)] {
            assert!(matches!(write(&path, image), Err(Error::Output { file, .. }) if file == path));
        }
        let tone = Tone { exposure_ev: f32::NAN, map: ToneMap::Clamp };
        assert!(matches!(output::write(&path, &grey(4, 4), &metadata(false), &tone), Err(Error::Setting { .. })));
        assert_eq!(fs::read(&path).unwrap(), b"precious");
    }
    assert_eq!(names(folder.path()), ["old.exr", "old.hdr", "old.png", "old.ppm"]);
}

#[test]
fn an_old_file_is_replaced() {
    let folder = folder();
    let path = folder.path().join("a.ppm");
    fs::write(&path, vec![0; 10_000]).unwrap();
    write(&path, &grey(1, 1)).unwrap();
    assert_eq!(size_of(&path), (1, 1));
    assert!(fs::metadata(&path).unwrap().len() < 1000);
    assert_eq!(names(folder.path()), ["a.ppm"]);
}

#[test]
fn unusable_targets_are_found_before_and_when_writing() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    fs::create_dir(at("folder.png")).unwrap();
    fs::write(at("file"), "").unwrap();
    fs::write(at("locked.png"), "precious").unwrap();
    let mut permissions = fs::metadata(at("locked.png")).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(at("locked.png"), permissions).unwrap();
    let long = format!("{}.png", "x".repeat(300));
    for name in ["folder.png", "missing/a.png", "file/a.png", "locked.png", "new.png/", "a.jpg", "a", long.as_str()] {
        let path = at(name);
        for result in [output::check_writable(&path), write(&path, &grey(1, 1))] {
            let message = result.expect_err(name).to_string();
            assert!(message.starts_with(&*path.to_string_lossy()), "{message}");
        }
    }
    assert!(output::check_writable(Path::new("")).is_err());
    assert_eq!(names(folder.path()), ["file", "folder.png", "locked.png"]);
    assert_eq!(fs::read(at("locked.png")).unwrap(), b"precious");
}

#[test]
fn checking_changes_nothing() {
    let folder = folder();
    let old = folder.path().join("old.exr");
    fs::write(&old, "precious").unwrap();
    output::check_writable(&old).unwrap();
    output::check_writable(&folder.path().join("new.HDR")).unwrap();
    output::check_writable(Path::new("bare-name.png")).unwrap();
    assert_eq!(names(folder.path()), ["old.exr"]);
    assert_eq!(fs::read(&old).unwrap(), b"precious");
}

#[test]
fn one_failure_does_not_lose_the_others() {
    let folder = folder();
    let paths: Vec<PathBuf> =
        ["a.png", "missing/b.png", "c.jpg", "d.exr"].map(|name| folder.path().join(name)).to_vec();
    let results = output::write_all(&paths, &grey(2, 2), &metadata(false), &Tone::default());
    assert_eq!(results.iter().map(Result::is_ok).collect::<Vec<_>>(), [true, false, false, true]);
    assert_eq!(names(folder.path()), ["a.png", "d.exr"]);
}

#[test]
fn default_names_never_overwrite() {
    let folder = folder();
    let name = output::default_name(output::local_now());
    let stem = name.strip_suffix(".png").unwrap();
    let shape: String = stem.chars().map(|c| if c.is_ascii_digit() { '0' } else { c }).collect();
    assert_eq!(shape, "00_00_00-00_00_00");
    let second = folder.path().join(format!("{stem}-2.png"));
    fs::write(&second, "precious").unwrap();
    let new = || output::write_new(folder.path(), &name, &grey(1, 1), &metadata(false), &Tone::default()).unwrap();
    assert_eq!(new(), folder.path().join(&name));
    assert_eq!(new(), folder.path().join(format!("{stem}-3.png")));
    assert_eq!(fs::read(&second).unwrap(), b"precious");
    // Many at once: each gets a name of its own.
    let mut written: Vec<PathBuf> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..8).map(|_| scope.spawn(new)).collect();
        threads.into_iter().map(|thread| thread.join().unwrap()).collect()
    });
    written.sort();
    written.dedup();
    assert_eq!(written.len(), 8);
    assert_eq!(names(folder.path()).len(), 11);
    assert!(written.iter().all(|path| size_of(path) == (1, 1)));
}

#[test]
fn a_default_name_in_a_missing_folder_is_an_error() {
    let folder = folder();
    let missing = folder.path().join("missing");
    let error = output::write_new(&missing, "a.png", &grey(1, 1), &metadata(false), &Tone::default()).unwrap_err();
    assert!(error.to_string().contains("missing"), "{error}");
    assert!(names(folder.path()).is_empty());
}

#[cfg(unix)]
mod unix {
    use std::{
        os::unix::fs::{PermissionsExt, symlink},
        process::Command,
    };

    use super::*;

    fn mode(path: &Path) -> u32 {
        fs::metadata(path).unwrap().permissions().mode() & 0o7777
    }

    #[test]
    fn permissions_are_those_of_any_file() {
        let folder = folder();
        let at = |name: &str| folder.path().join(name);
        File::create(at("any")).unwrap();
        write(&at("new.png"), &grey(1, 1)).unwrap();
        assert_eq!(mode(&at("new.png")), mode(&at("any")));
        let named = output::write_new(folder.path(), "a.png", &grey(1, 1), &metadata(false), &Tone::default()).unwrap();
        assert_eq!(mode(&named), mode(&at("any")));
        for kept in [0o600, 0o640, 0o666] {
            fs::set_permissions(at("new.png"), PermissionsExt::from_mode(kept)).unwrap();
            write(&at("new.png"), &grey(1, 1)).unwrap();
            assert_eq!(mode(&at("new.png")), kept);
        }
    }

    #[test]
    fn links_are_followed() {
        let folder = folder();
        let at = |name: &str| folder.path().join(name);
        fs::create_dir(at("real")).unwrap();
        symlink("real/target.png", at("near.png")).unwrap();
        symlink(at("near.png"), at("far.png")).unwrap();
        // The first time the target is not there yet.
        for size in [1, 2] {
            output::check_writable(&at("far.png")).unwrap();
            write(&at("far.png"), &grey(size, size)).unwrap();
            assert_eq!(size_of(&at("real/target.png")), (size, size));
        }
        assert!(fs::symlink_metadata(at("near.png")).unwrap().is_symlink());
        assert!(fs::symlink_metadata(at("far.png")).unwrap().is_symlink());
        assert_eq!(names(&at("real")), ["target.png"]);
        symlink("loop.png", at("loop.png")).unwrap();
        symlink("missing/a.png", at("nowhere.png")).unwrap();
        for name in ["loop.png", "nowhere.png"] {
            assert!(output::check_writable(&at(name)).is_err(), "{name}");
            assert!(write(&at(name), &grey(1, 1)).is_err(), "{name}");
        }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn devices_are_written_to_and_stay_devices() {
        use std::os::{fd::AsRawFd, unix::fs::FileTypeExt};
        let folder = folder();
        let device = |path: &str| fs::metadata(path).unwrap().file_type().is_char_device();
        output::check_writable(Path::new("/dev/null")).unwrap();
        write(Path::new("/dev/null"), &grey(4, 4)).unwrap();
        let message = write(Path::new("/dev/full"), &grey(4, 4)).unwrap_err().to_string();
        assert!(message.starts_with("/dev/full: cannot write: "), "{message}");
        for ending in ENDINGS {
            let link = folder.path().join("full").with_extension(ending);
            symlink("/dev/full", &link).unwrap();
            let error = write(&link, &grey(4, 4)).unwrap_err();
            let full = |source: &std::io::Error| source.kind() == std::io::ErrorKind::StorageFull;
            assert!(matches!(&error, Error::Io { file, source, .. } if *file == link && full(source)), "{error}");
        }
        assert!(device("/dev/null") && device("/dev/full"));
        // As /dev/stdout with standard output sent to a file.
        let redirected = File::create(folder.path().join("redirected")).unwrap();
        write(Path::new(&format!("/dev/fd/{}", redirected.as_raw_fd())), &grey(2, 3)).unwrap();
        let info = read_png(&folder.path().join("redirected")).0;
        assert_eq!((info.width, info.height), (2, 3));
        assert_eq!(redirected.metadata().unwrap().len(), fs::metadata(folder.path().join("redirected")).unwrap().len());
    }

    /// Set for the child process of [`a_full_disk_leaves_nothing_behind`]: the folder to write to.
    const CHILD_FOLDER: &str = "WAVETRACE_TEST_FULL_DISK";

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_leaves_nothing_behind() {
        let folder = folder();
        for ending in ENDINGS {
            fs::write(folder.path().join("old").with_extension(ending), "precious").unwrap();
        }
        // A process whose files may not grow past 4 KiB, and which lives on when they try.
        let limited = r#"trap '' XFSZ; ulimit -f 8; exec "$0" --exact unix::in_a_small_disk --ignored"#;
        let output = Command::new("sh")
            .args(["-c", limited])
            .arg(std::env::current_exe().unwrap())
            .env(CHILD_FOLDER, folder.path())
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success() && said.contains("1 passed"), "{said}");
        assert_eq!(names(folder.path()), ["old.exr", "old.hdr", "old.png", "old.ppm"]);
        for ending in ENDINGS {
            assert_eq!(fs::read(folder.path().join("old").with_extension(ending)).unwrap(), b"precious");
        }
    }

    #[test]
    #[ignore = "the child process of a_full_disk_leaves_nothing_behind"]
    fn in_a_small_disk() {
        let Some(folder) = std::env::var_os(CHILD_FOLDER).map(PathBuf::from) else { return };
        // Noise, which does not compress into the 4 KiB.
        let noise = image(128, 128, |i| [13, 7, 29].map(|k| (f64::from(i * k).sin() * 1e4).fract().abs() as f32));
        for ending in ENDINGS {
            for stem in ["old", "new"] {
                let path = folder.join(stem).with_extension(ending);
                output::check_writable(&path).unwrap();
                assert!(matches!(write(&path, &noise), Err(Error::Io { file, .. }) if file == path), "{stem}.{ending}");
            }
        }
        assert!(output::write_new(&folder, "name.png", &noise, &metadata(false), &Tone::default()).is_err());
    }
}
