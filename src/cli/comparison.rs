//! The figures of a comparison, as a table and as JSON.

use super::args::CompareArgs;
use super::choices::Metric;
use super::units::{count, counted, short};
use serde_json::{Value, json};
use std::fmt::Write;
use wavetrace::report::errors::{Errors, Figure, Means};
use wavetrace::report::welch::{ALPHA, BINS, Welch};

/// Characters of the longest bar of the histogram.
const BAR: usize = 40;
const CHANNELS: [&str; 3] = ["red", "green", "blue"];

/// All that is known of two images.
pub struct Comparison<'a> {
    /// What was compared.
    pub args: &'a CompareArgs,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// relMSE, MSE, PSNR, means, and pixels left out.
    pub errors: Errors,
    /// relMSE less the reference's own noise, where that is known.
    pub rel_mse_less_noise: Option<Figure>,
    /// Mean of FLIP, where it was asked for.
    pub flip: Option<Figure>,
    /// The t-test, where variances are known.
    pub welch: Option<Welch>,
}

impl Comparison<'_> {
    /// For people.
    pub fn table(&self) -> String {
        let (args, errors) = (self.args, &self.errors);
        let mut text = format!(
            "A {}\nB {}, the reference\n{}x{} pixels, {} compared{}\n",
            args.image.display(),
            args.reference.display(),
            self.width,
            self.height,
            count(errors.pixels as u64),
            self.flaws(),
        );
        let trimmed = format!("without the worst {}", count(errors.trimmed as u64));
        let mut rows = Vec::new();
        let mut row = |metric: Metric, name: &str, figure: Figure, unit: &str| {
            if args.wants(metric) {
                rows.push(format!("{name:<18} {:>14} {:>22}{unit}", digits(figure.raw), digits(figure.trimmed)));
            }
        };
        row(Metric::Relmse, "relMSE", errors.rel_mse, "");
        if let Some(figure) = self.rel_mse_less_noise {
            row(Metric::Relmse, "  less B's noise", figure, "");
        }
        row(Metric::Mse, "MSE", errors.mse, "");
        row(Metric::Psnr, "PSNR", errors.psnr, " dB");
        if let Some(figure) = self.flip {
            row(Metric::Flip, "FLIP", figure, "");
        }
        let [a, b] = &errors.means;
        let pairs = (0..3).map(|k| (CHANNELS[k], a.rgb[k], b.rgb[k]));
        for (channel, a, b) in [("luminance", a.luminance, b.luminance)].into_iter().chain(pairs) {
            row(Metric::Mean, &format!("mean {channel} A"), a, "");
            row(Metric::Mean, &format!("mean {channel} B"), b, "");
            row(Metric::Mean, "  A / B", Figure { raw: a.raw / b.raw, trimmed: a.trimmed / b.trimmed }, "");
        }
        let _ = write!(text, "\n{:<18} {:>14} {trimmed:>22}\n{}", "", "all", rows.join("\n"));
        if let Some(welch) = &self.welch {
            text += &self.test(welch);
        }
        text
    }

    /// What was left out, if anything.
    fn flaws(&self) -> String {
        let named = |name: &str, k: usize| {
            let flaws = self.errors.flaws[k];
            let some = [(flaws.nan, "NaN"), (flaws.infinite, "infinite")].into_iter().filter(|&(n, _)| n > 0);
            some.map(|(n, what)| format!("; {} {what} in {name}", count(n as u64))).collect::<String>()
        };
        named("A", 0) + &named("B", 1)
    }

    fn test(&self, welch: &Welch) -> String {
        let squares = match welch.side {
            1 => "pixel".to_owned(),
            side => format!("square of {side}x{side} pixels"),
        };
        let (tests, rejected) = (count(welch.tests() as u64), count(welch.rejected as u64));
        let mut text = format!("\n\nt-test: the images {}, at the significance {ALPHA}", verdict(welch));
        let _ = write!(text, "\n  by {squares}: {rejected} below p = {} in {tests} tests", short(welch.level));
        if let Some((p, [x, y])) = welch.smallest {
            let _ = write!(text, "; the smallest is {}, at {x},{y}", short(p));
        }
        let level = short(welch.channel_level());
        let list = |p: [String; 3]| p.join(", ");
        let means = welch.channels.map(|channel| short(channel.mean));
        let _ = write!(text, "\n  means    p = {} of equal means in red, green and blue; level {level}", list(means));
        text += "\n  p-values ";
        if welch.channels.iter().all(|channel| channel.uniformity.is_none()) {
            text += "too few to be judged";
        } else {
            let uniform = welch.channels.map(|channel| channel.uniformity.map_or("?".to_owned(), short));
            let _ = write!(text, "p = {} of being uniform; level {level}", list(uniform));
        }
        let level = welch.channel_level();
        if welch.too_many_small().contains(&true) {
            text += ", with too many small ones";
        } else if welch.channels.iter().any(|channel| channel.uniformity.is_some_and(|p| p < level)) {
            text += ", but without too many small ones";
        }
        for (what, n) in [
            ("exact and equal", welch.exact),
            ("exact and not equal", welch.unequal),
            ("of unknown variance", welch.unknown),
        ] {
            if n > 0 {
                let _ = write!(text, "\n  {} {what}", counted(n as u64, "component"));
            }
        }
        let histogram = welch.histogram();
        let most = histogram.iter().copied().max().unwrap_or(0).max(1);
        for (bin, n) in histogram.into_iter().enumerate() {
            let (from, to) = (bin as f64 / BINS as f64, (bin + 1) as f64 / BINS as f64);
            let bar = "#".repeat((n * BAR).div_ceil(most));
            let _ = write!(text, "\n  {from:.2}-{to:.2} {:>12} {bar}", count(n as u64));
        }
        text
    }

    /// For programs. Numbers that are not finite are null.
    pub fn json(&self) -> Value {
        let (args, errors) = (self.args, &self.errors);
        let wanted = |metric: Metric, value: Value| if args.wants(metric) { value } else { Value::Null };
        let means = |means: &Means| json!({ "luminance": figure(means.luminance), "rgb": means.rgb.map(figure) });
        let [a, b] = errors.flaws;
        json!({
            "program": "wavetrace",
            "version": env!("CARGO_PKG_VERSION"),
            "image": args.image.display().to_string(),
            "reference": args.reference.display().to_string(),
            "width": self.width,
            "height": self.height,
            "pixels": errors.pixels,
            "trimmed_pixels": errors.trimmed,
            "nan_pixels": { "image": a.nan, "reference": b.nan },
            "infinite_pixels": { "image": a.infinite, "reference": b.infinite },
            "relmse": wanted(Metric::Relmse, figure(errors.rel_mse)),
            "relmse_less_noise": wanted(Metric::Relmse, self.rel_mse_less_noise.map_or(Value::Null, figure)),
            "mse": wanted(Metric::Mse, figure(errors.mse)),
            "psnr": wanted(Metric::Psnr, figure(errors.psnr)),
            "flip": self.flip.map_or(Value::Null, figure),
            "mean": wanted(Metric::Mean, json!({ "image": means(&errors.means[0]), "reference": means(&errors.means[1]) })),
            "t_test": self.welch.as_ref().map(test_json),
        })
    }
}

fn test_json(welch: &Welch) -> Value {
    let channels = &welch.channels;
    json!({
        "verdict": verdict(welch),
        "significance": ALPHA,
        "block": welch.side,
        "tests": welch.tests(),
        "level": welch.level,
        "below": welch.rejected,
        "smallest_p": welch.smallest.map(|smallest| smallest.0),
        "smallest_at": welch.smallest.map(|smallest| smallest.1),
        "channel_level": welch.channel_level(),
        "mean_p": channels.map(|channel| channel.mean),
        "uniformity_p": channels.map(|channel| channel.uniformity),
        "too_many_small": welch.too_many_small(),
        "histogram": welch.histogram(),
        "exact": welch.exact,
        "unequal": welch.unequal,
        "unknown": welch.unknown,
    })
}

fn verdict(welch: &Welch) -> &'static str {
    match (welch.is_known(), welch.differ()) {
        (false, _) => "are not tested",
        (true, false) => "agree",
        (true, true) => "differ",
    }
}

fn figure(figure: Figure) -> Value {
    json!({ "raw": figure.raw, "trimmed": figure.trimmed })
}

/// Five significant digits.
fn digits(value: f64) -> String {
    match value {
        v if v == 0.0 || !v.is_finite() => v.to_string(),
        v if (1e-3..1e6).contains(&v.abs()) => {
            let places = (4 - v.abs().log10().floor() as i32).max(0) as usize;
            format!("{v:.places$}")
        }
        v => format!("{v:.4e}"),
    }
}
