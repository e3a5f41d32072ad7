//! `wavetrace compare`: how far is an image from a reference, and is that more than noise?

use super::Exit;
use super::args::CompareArgs;
use super::choices::Metric;
use super::comparison::Comparison;
use super::messages::Console;
use super::outputs::same_file;
use super::units::{counted, short};
use std::path::{Path, PathBuf};
use wavetrace::error::{Error, Result as LibraryResult};
use wavetrace::output::{self, Format, ImageFile, Metadata, Tone};
use wavetrace::report::errors::{rel_mse_less_variance, relative_squared_error};
use wavetrace::report::welch::side_for;
use wavetrace::report::{Measured, Scale, Viewing, Welch, errors, flip, welch};

/// Compares two images, shows the figures, and writes the heat map.
pub fn run(args: &CompareArgs) -> Result<Exit, Exit> {
    let console = Console::new(false, false);
    check(args, &console)?;
    let (comparison, map) = compare(args, &console).map_err(|error| console.fail(&error))?;
    if let Some(path) = &args.heatmap {
        let image = output::from_srgb8(comparison.width, comparison.height, &map.colours);
        output::write(path, &image, &metadata(args, map.scale), &Tone::default())
            .map_err(|error| console.fail(&error))?;
    }
    if args.json {
        console.answer(format_args!("{:#}", comparison.json()))?;
    } else {
        console.answer(comparison.table())?;
    }
    if let Some(path) = &args.heatmap {
        let [low, high] = map.scale.range().map(short);
        console.line(format_args!("wrote {}: {}, black {low} to yellow {high}", path.display(), what(map.scale)));
    }
    Ok(Exit::Done)
}

/// Looks at the command line, and whether the heat map can be written, before anything is done.
fn check(args: &CompareArgs, console: &Console) -> Result<(), Exit> {
    if args.stddev.len() > 2 {
        let (setting, found) = ("--stddev", format!("{} files", args.stddev.len()));
        return Err(console.fail(&Error::Setting { setting, found, expected: "one or two".to_owned() }));
    }
    let Some(path) = &args.heatmap else { return Ok(()) };
    if [&args.image, &args.reference].into_iter().chain(&args.stddev).any(|input| same_file(input, path)) {
        let reason = "found an image that is compared, expected a file of its own for --heatmap".to_owned();
        console.error(Error::Output { file: path.clone(), reason });
        return Err(Exit::Usage);
    }
    output::check_writable(path).map_err(|error| {
        console.error(&error);
        if Format::from_path(path).is_err() { Exit::Usage } else { Exit::Fault }
    })
}

/// Colours of the pixels, and what they mean.
struct Map {
    scale: Scale,
    colours: Vec<[u8; 3]>,
}

fn compare<'a>(args: &'a CompareArgs, console: &Console) -> LibraryResult<(Comparison<'a>, Map)> {
    let (mut a, mut b) = (read(&args.image, console)?, read(&args.reference, console)?);
    check_size(&args.image, &a, &args.reference, &b)?;
    note_limits([(&args.image, &a), (&args.reference, &b)], console);
    let [deviations_a, deviations_b] = deviations(args, [&a, &b], console)?;
    let variances = [deviations_a.or(a.variance.take()), deviations_b.or(b.variance.take())];
    let (image, reference) = (&a.image.pixels, &b.image.pixels);
    let figures = errors(image, reference)?;
    let scale = if args.wants_flip_alone() { Scale::Flip } else { Scale::RelativeError };
    let mut map = Map { scale, colours: Vec::new() };
    let mut mean_flip = None;
    if args.wants(Metric::Flip) {
        let viewing = Viewing { exposure_ev: args.exposure.into(), ..Viewing::default() };
        let found = flip(image, reference, a.image.width as usize, &viewing)?;
        mean_flip = Some(found.mean);
        if scale == Scale::Flip && args.heatmap.is_some() {
            map.colours = found.map.iter().map(|&value| scale.colour(value.into())).collect();
        }
    }
    if scale == Scale::RelativeError && args.heatmap.is_some() {
        let pairs = image.iter().zip(reference);
        map.colours = pairs.map(|(&a, &b)| scale.colour(relative_squared_error(a, b))).collect();
    }
    let comparison = Comparison {
        args,
        width: a.image.width,
        height: a.image.height,
        errors: figures,
        rel_mse_less_noise: match &variances[1] {
            Some(variance) => Some(rel_mse_less_variance(image, reference, variance)?),
            None => None,
        },
        flip: mean_flip,
        welch: test(args, [&a, &b], &variances, console)?,
    };
    Ok((comparison, map))
}

/// Reads an image and says what is odd about it.
fn read(path: &Path, console: &Console) -> LibraryResult<ImageFile> {
    let file = output::read(path)?;
    for remark in &file.remarks {
        console.warn(format_args!("{}: {remark}", path.display()));
    }
    if file.metadata.partial {
        console.note(format_args!("{}: its rendering was interrupted", path.display()));
    }
    Ok(file)
}

fn check_size(path: &Path, file: &ImageFile, other_path: &Path, other: &ImageFile) -> LibraryResult<()> {
    let size = |file: &ImageFile| (file.image.width, file.image.height);
    if size(file) == size(other) {
        return Ok(());
    }
    let text = |(width, height)| format!("{width}x{height} pixels");
    let expected = format!("{} as in {}", text(size(other)), other_path.display());
    Err(Error::Decode { file: path.to_owned(), found: text(size(file)), expected })
}

/// Says where one format cannot hold what is in the other.
fn note_limits(files: [(&PathBuf, &ImageFile); 2], console: &Console) {
    let is_limited = |file: &ImageFile| matches!(file.format, Format::Png | Format::Ppm);
    let [a, b] = files;
    for ((path, file), (other_path, other)) in [(a, b), (b, a)] {
        let bright = other.image.pixels.iter().filter(|pixel| pixel.iter().any(|&c| c > 1.0)).count();
        if is_limited(file) && !is_limited(other) && bright > 0 {
            let (path, other, bright) = (path.display(), other_path.display(), counted(bright as u64, "pixel"));
            console.note(format_args!("{path}: its format holds nothing above 1; in {other} {bright} are brighter"));
        }
    }
}

/// Squares of the standard deviations that the user named, of both images. One file alone belongs to the image without
/// variances of its own, to the reference where neither has any.
fn deviations(
    args: &CompareArgs,
    files: [&ImageFile; 2],
    console: &Console,
) -> LibraryResult<[Option<Vec<[f32; 3]>>; 2]> {
    let mut squares = Vec::new();
    for path in &args.stddev {
        let file = read(path, console)?;
        check_size(path, &file, &args.image, files[0])?;
        squares.push(file.image.pixels.into_iter().map(|pixel| pixel.map(|c| c * c)).collect());
    }
    let mut squares = squares.into_iter();
    match (squares.next(), squares.next(), files.map(|file| file.variance.is_some())) {
        (Some(_), None, [true, true]) => Err(Error::Setting {
            setting: "--stddev",
            found: "one file, and variances in both images".to_owned(),
            expected: "two files, for A and for B, or none".to_owned(),
        }),
        (Some(one), None, [false, true]) => Ok([Some(one), None]),
        (Some(one), None, [_, false]) => Ok([None, Some(one)]),
        (a, b, _) => Ok([a, b]),
    }
}

/// The t-test, where variances are known.
fn test(
    args: &CompareArgs,
    files: [&ImageFile; 2],
    variances: &[Option<Vec<[f32; 3]>>; 2],
    console: &Console,
) -> LibraryResult<Option<Welch>> {
    let paths = [&args.image, &args.reference];
    if args.stddev.is_empty() && variances.iter().any(Option::is_none) {
        for (path, _) in
            paths.iter().zip(variances).filter(|(_, own)| own.is_none() && variances.iter().any(Option::is_some))
        {
            console.note(format_args!("{}: found no variances: no t-test without `--stddev`", path.display()));
        }
        return Ok(None);
    }
    let entry = |k: usize, key: &str| files[k].metadata.get(key);
    for (k, path) in paths.into_iter().enumerate() {
        if variances[k].is_none() {
            console.warn(format_args!("{}: found no variances, it is taken as exact", path.display()));
        } else if entry(k, "sampler") == Some("sobol") {
            let path = path.display();
            console.warn(format_args!(
                "{path}: its samples are Sobol points, and their spread overestimates its variance"
            ));
        }
    }
    if ["scene", "seed", "sampler"].into_iter().all(|key| entry(0, key).is_some() && entry(0, key) == entry(1, key)) {
        console.warn("both images have the same scene and seed: they are not independent, and the t-test says little");
    }
    let side = |k: usize| {
        // Of an interrupted render not every pixel has all samples.
        let samples = entry(k, "spp").and_then(|spp| spp.parse().ok()).filter(|_| !files[k].metadata.partial);
        Measured { pixels: &files[k].image.pixels, variance: variances[k].as_deref(), samples }
    };
    let (a, b) = (side(0), side(1));
    // Skewness cancels out where the samples are of one kind and as many.
    let alike =
        ["spp", "method", "sampler"].into_iter().all(|key| entry(0, key).is_some() && entry(0, key) == entry(1, key));
    let block = match args.block {
        Some(block) => block as usize,
        None if alike => 1,
        None => side_for([a, b].map(|side| side.variance.and(side.samples))),
    };
    welch(a, b, files[0].image.width as usize, block).map(Some)
}

fn what(scale: Scale) -> &'static str {
    match scale {
        Scale::RelativeError => "relative squared error",
        Scale::Flip => "FLIP",
    }
}

fn metadata(args: &CompareArgs, scale: Scale) -> Metadata {
    let [low, high] = scale.range().map(short);
    let entries = [
        ("Software", format!("wavetrace {}", env!("CARGO_PKG_VERSION"))),
        ("image", args.image.display().to_string()),
        ("reference", args.reference.display().to_string()),
        ("shows", format!("{}, {low} to {high}", what(scale))),
    ];
    Metadata { entries: entries.map(|(key, value)| (key.to_owned(), value)).to_vec(), partial: false }
}
