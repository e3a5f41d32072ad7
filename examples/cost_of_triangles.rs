//! What a ray costs against the number of triangles: measures rooms from 10^3 to 10^7 triangles and draws the chart.
//! `cargo run --release --example cost_of_triangles -- OUT.csv OUT.svg [--triangles N,...] [--import OTHER.csv] [--redraw]`.
//!
//! A row of CSV is `triangles,set,mrays_per_s`; those of another tracer are drawn as dots, in the same colours. The set
//! `build` is the build of the tree, in millions of triangles per second on all cores.

use clap::Parser;
use plotters::prelude::*;
use std::cell::RefCell;
use std::error::Error;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;
use wavetrace::accel::Bvh;
use wavetrace::bench::{self, HitRecord, Kernel, Options, SetKind, Tracer, measure, mesh, room, trace};

/// Draws what a ray costs against the number of triangles.
#[derive(Parser)]
struct Args {
    /// Measurements go here
    csv: PathBuf,
    /// The chart goes here
    svg: PathBuf,
    /// Sizes of the rooms
    #[arg(long, value_delimiter = ',', default_value = "1000,3000,10000,30000,100000,300000,1000000,3000000,10000000",
        value_parser = clap::value_parser!(u32).range(room::MIN_TRIANGLES as i64..=10_000_000))]
    triangles: Vec<u32>,
    /// Measurements of another tracer
    #[arg(long)]
    import: Option<PathBuf>,
    /// Draw what the first file holds already
    #[arg(long)]
    redraw: bool,
}

const REPEATS: usize = 5;
const COLOURS: [RGBColor; 5] =
    [RGBColor(0, 90, 181), RGBColor(220, 50, 32), RGBColor(120, 94, 240), RGBColor(0, 140, 70), RGBColor(230, 140, 0)];

/// (triangles, set, millions per second)
type Row = (f64, String, f64);

fn measured(triangles: u32) -> Result<Vec<Row>, Box<dyn Error>> {
    let corners = mesh::corners(&room(triangles as usize, 1));
    let n = corners.len() as f64;
    let clock = Instant::now();
    let bvh = Bvh::build(&corners);
    let mut rows = vec![(n, "build".to_owned(), n / clock.elapsed().as_secs_f64() / 1e6)];
    let tracer = Tracer { bvh: &bvh, kernel: Kernel::Auto, threads: 1 };
    let (sets, _) = bench::make(&corners, &tracer, &Options::default(), &SetKind::ALL)?;
    let hits: Vec<_> = sets.iter().map(|set| RefCell::new(vec![HitRecord::MISS; set.rays.len()])).collect();
    let cases = sets.iter().zip(&hits).map(|(set, hits)| trace(set.kind.name().to_owned(), tracer, set, hits));
    rows.extend(
        measure(cases.collect(), REPEATS, |_| true).into_iter().map(|figure| (n, figure.name.clone(), figure.median())),
    );
    Ok(rows)
}

fn read(csv: &Path) -> Result<Vec<Row>, Box<dyn Error>> {
    let text = std::fs::read_to_string(csv).map_err(|e| format!("{}: {e}", csv.display()))?;
    let row = |line: &str| -> Result<Row, Box<dyn Error>> {
        let fields: Vec<&str> = line.split(',').collect();
        let [n, set, rate] = fields[..] else {
            return Err(format!("{}: {line:?}: 3 fields expected", csv.display()).into());
        };
        let number =
            |text: &str| text.parse().map_err(|_| format!("{}: {line:?}: {text:?} is no number", csv.display()));
        Ok((number(n)?, set.to_owned(), number(rate)?))
    };
    text.lines().skip(1).map(row).collect()
}

fn draw(svg: &Path, own: &[Row], other: &[Row]) -> Result<(), Box<dyn Error>> {
    let root = SVGBackend::new(svg, (860, 520)).into_drawing_area();
    root.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&root)
        .margin(16)
        .x_label_area_size(46)
        .y_label_area_size(64)
        .build_cartesian_2d((700f64..14e6).log_scale(), (10f64..2000.0).log_scale())?;
    chart
        .configure_mesh()
        .x_desc("triangles")
        .y_desc("ns per ray, one thread")
        .x_label_formatter(&|n| format!("{n:.0e}"))
        .y_label_formatter(&|ns| format!("{ns:.0}"))
        .label_style(("sans-serif", 14))
        .draw()?;
    for (kind, colour) in SetKind::ALL.iter().zip(COLOURS) {
        let of = |rows: &[Row]| -> Vec<(f64, f64)> {
            rows.iter().filter(|(_, set, _)| set == kind.name()).map(|&(n, _, rate)| (n, 1e3 / rate)).collect()
        };
        chart
            .draw_series(LineSeries::new(of(own), colour.stroke_width(2)))?
            .label(kind.name())
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 22, y)], colour.stroke_width(2)));
        chart.draw_series(of(other).into_iter().map(|at| Circle::new(at, 4, colour.stroke_width(2))))?;
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperLeft)
        .background_style(WHITE.mix(0.9))
        .border_style(BLACK.mix(0.3))
        .label_font(("sans-serif", 14))
        .draw()?;
    root.present()?;
    Ok(())
}

/// Measures all rooms; each is in the table before the next one.
fn measure_all(args: &Args) -> Result<Vec<Row>, Box<dyn Error>> {
    let mut csv = File::create(&args.csv).map_err(|e| format!("{}: {e}", args.csv.display()))?;
    writeln!(csv, "triangles,set,mrays_per_s")?;
    let mut own = Vec::new();
    for &n in &args.triangles {
        let rows = measured(n)?;
        for (n, set, rate) in &rows {
            writeln!(csv, "{n},{set},{rate:.3}")?;
        }
        println!("{n}: {}", rows.iter().map(|(_, set, rate)| format!("{set} {rate:.2}  ")).collect::<String>());
        own.extend(rows);
    }
    Ok(own)
}

fn main() -> Result<(), Box<dyn Error>> {
    let args = Args::parse();
    let other = args.import.as_deref().map(read).transpose()?.unwrap_or_default();
    let own = if args.redraw { read(&args.csv)? } else { measure_all(&args)? };
    draw(&args.svg, &own, &other)
}
