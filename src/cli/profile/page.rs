//! The page of a profile.

use super::Profile;
use super::drawings::series;
use crate::cli::facts;
use crate::cli::units::{bytes, count, counted, per_pixel, si, time};
use wavetrace::chart::bars::key;
use wavetrace::chart::draw::panel_element;
use wavetrace::chart::number::figure;
use wavetrace::chart::svg::escape;
use wavetrace::chart::{Build, Machine, Sheet};
use wavetrace::probe::{COUNTED, StageRow};

/// A heading and what stands below it; `text` and `content` are HTML.
fn section(title: &str, text: &str, content: &str) -> String {
    let title = escape(title);
    format!(r#"<section aria-label="{title}"><h2>{title}</h2><p>{text}</p>{content}</section>"#)
}

/// A table in HTML, its cells text.
fn table(head: &[&str], rows: &[Vec<String>]) -> String {
    let cells = |row: &[String], tag: &str| {
        row.iter().map(|cell| format!("<{tag}>{}</{tag}>", escape(cell))).collect::<String>()
    };
    let head: Vec<String> = head.iter().map(|&word| word.to_owned()).collect();
    let body: String = rows.iter().map(|row| format!("<tr>{}</tr>", cells(row, "td"))).collect();
    format!(
        r#"<div class="scroll"><table><thead><tr>{}</tr></thead><tbody>{body}</tbody></table></div>"#,
        cells(&head, "th")
    )
}

impl Profile<'_> {
    /// The page as HTML.
    pub fn page(&self) -> String {
        let panels =
            |name: &str, content: &str| format!(r#"<div class="panels">{}</div>"#, panel_element(name, content));
        let sections = [
            section("Stages", &self.about_stages(), &self.stages()),
            section(
                "Time by bounces",
                "Each bar is the time that all threads spent on paths with that number of bounces, stage by stage; of a \
                 render whose waves are not refilled, so that all paths of a wave have as many. Light paths count from \
                 their lamp on.",
                &panels("Time by bounces", &self.breakdown()),
            ),
            section(
                "Lanes in use",
                "Rows are taken eight at a time; the last ones of a run fill their lanes in part.",
                &panels("Lanes in use", &self.occupancy()),
            ),
            section(
                "Limits of the machine",
                &self.about_roof(),
                &panels("Roofline", &self.roof()),
            ),
            section(
                "Timeline",
                "Some milliseconds about the middle of the render. <code>--trace</code> writes a timeline of all of it for Perfetto; of a \
                 long render it has the stages of every second 8 milliseconds, of every fourth, and so on.",
                &format!(r#"<div class="panels">{}</div>"#, self.timeline()),
            ),
            self.counters(),
            section("Memory", "What is held while the render runs, column by column.", &self.memory()),
            section("Plan", "Which stages this scene needs, and which it leaves out.", &format!("<pre>{}</pre>", escape(&self.plan.to_string()))),
        ]
        .concat();
        let world = self.renderer.world();
        let title = format!("Profile of {}", self.args.scene.display());
        let mut facts = facts::machine(&Build::this(), &Machine::here());
        let effort = format!("{}x{} pixels, {}", world.width(), world.height(), per_pixel(self.settings.spp));
        let machine = format!(
            "{} Gflop/s, {} GB/s from a core's own cache, {} GB/s from memory; one thread, best of three",
            figure(self.limits.gflops),
            figure(self.limits.cache),
            figure(self.limits.memory)
        );
        facts.extend(
            [
                ("render", effort),
                ("threads", self.usual.threads.to_string()),
                ("limits", machine),
                ("page made", facts::local_time()),
            ]
            .map(|(name, value)| (name.to_owned(), value)),
        );
        let sheet = Sheet {
            title: &title,
            summary: self.summary(),
            bar: key(&series()),
            sections,
            facts: &facts,
            command: &facts::command(),
        };
        sheet.html()
    }

    fn summary(&self) -> String {
        let (counts, seconds) = (&self.usual.counts, self.usual.time.as_secs_f64());
        format!(
            "<p>{} of rendering after {} of loading and {} of building: {}rays/s, {}samples/s with {}. {} of {} threads' time \
             is in stages; the rest is sorting samples into the image, waiting, and starting.</p>",
            time(self.usual.time),
            time(self.before[0]),
            time(self.before[1]),
            si(counts.rays() as f64 / seconds),
            si(counts.camera as f64 / seconds),
            counted(self.usual.threads as u64, "thread"),
            share(self.stage_seconds(), seconds * self.usual.threads as f64),
            self.usual.threads
        )
    }

    fn stage_seconds(&self) -> f64 {
        self.usual.stages.iter().map(|row| row.time.as_secs_f64()).sum()
    }

    fn about_stages(&self) -> String {
        "The render as it is without this instrument, but for its clocks. GB/s are those of queues and samples for each \
         thread at work; what is looked up in the scene (the tree, corners, materials, lights) comes on top."
            .to_owned()
    }

    fn stages(&self) -> String {
        let all = self.stage_seconds();
        let row = |row: &StageRow| {
            let (seconds, bytes) = (row.time.as_secs_f64(), self.plan.stage_bytes(row.stage));
            let flops = self.arithmetic.per_row(row.stage);
            let intensity = flops.zip(bytes).map(|(flops, bytes)| flops / bytes as f64);
            let rate = |bytes: usize| figure(bytes as f64 * row.items as f64 / seconds / 1e9);
            vec![
                row.stage.name().to_owned(),
                share(seconds, all),
                figure(seconds * 1e3),
                count(row.calls),
                count(row.items),
                figure(row.ns_per_item()),
                share(row.occupancy(), 1.0),
                bytes.map_or("?".to_owned(), |bytes| bytes.to_string()),
                bytes.map_or("?".to_owned(), rate),
                flops.map_or("?".to_owned(), figure),
                intensity.map_or("?".to_owned(), figure),
            ]
        };
        let rows: Vec<_> = self.usual.stages.iter().filter(|row| row.items > 0).map(row).collect();
        table(
            &[
                "stage",
                "share",
                "ms",
                "runs",
                "rows",
                "ns/row",
                "lanes",
                "bytes/row",
                "GB/s",
                "flops/row",
                "flops/byte",
            ],
            &rows,
        )
    }

    fn counters(&self) -> String {
        let title = "Hardware counters";
        let counted = match &self.counted {
            Ok(counted) => counted,
            Err(reason) => return section(title, &format!("None: {}.", escape(reason)), ""),
        };
        let row = |row: &StageRow| {
            let counts = row.counted?;
            let each = counts.map(|count| count as f64 / row.items as f64);
            let cells = each.iter().map(|&each| figure(each));
            let per_cycle = figure(each[1] / each[0].max(1e-9));
            Some([row.stage.name().to_owned()].into_iter().chain(cells).chain([per_cycle]).collect())
        };
        let rows: Vec<Vec<String>> = counted.stages.iter().filter(|row| row.items > 0).filter_map(row).collect();
        let text = "For each row of a stage, of a render in which they are read before and after each run of a stage.";
        let head: Vec<String> = COUNTED.iter().map(|name| format!("{}/row", name.replace('_', " "))).collect();
        let head: Vec<&str> =
            ["stage"].into_iter().chain(head.iter().map(String::as_str)).chain(["instructions/cycle"]).collect();
        section(title, text, &table(&head, &rows))
    }

    fn about_roof(&self) -> String {
        let ran = self.usual.stages.iter().filter(|row| row.items > 0);
        let unknown: Vec<&str> =
            ran.filter(|row| self.arithmetic.per_row(row.stage).is_none()).map(|row| row.stage.name()).collect();
        let unknown = match unknown[..] {
            [] => String::new(),
            _ => format!(" Not counted: {}.", escape(&unknown.join(", "))),
        };
        format!(
            "One thread of this machine computes {} Gflop/s in eight lanes and reads {} GB/s from a cache of its own and {} \
             GB/s from memory, measured before the render. Each stage that computes is a point: operations were counted along \
             256 paths of this scene, followed by themselves; bytes are those of queues and samples, not what is looked up in \
             the scene.{unknown}",
            figure(self.limits.gflops),
            figure(self.limits.cache),
            figure(self.limits.memory),
        )
    }

    fn memory(&self) -> String {
        let (world, workers) = (self.renderer.world(), self.usual.threads);
        let mut rows: Vec<Vec<String>> = Vec::new();
        let mut row = |what: &str, name: &str, note: String, size: usize| {
            if size > 0 {
                rows.push(vec![format!("{what}: {name}"), note, bytes(size as u64)]);
            }
        };
        for (name, size) in world.columns() {
            row("scene", name, format!("{} triangles", count(world.triangles() as u64)), size);
        }
        row("tree", "nodes and leaves", String::new(), self.renderer.bvh().bytes());
        for (name, each) in self.plan.columns() {
            let paths = self.plan.wave_size * workers;
            row("waves", &name, format!("{each} bytes of each of {} paths", count(paths as u64)), each * paths);
        }
        row(
            "film",
            "sums",
            counted(u64::from(world.width()) * u64::from(world.height()), "pixel"),
            self.usual.film.bytes(),
        );
        table(&["what", "for", "held"], &rows)
    }
}

fn share(part: f64, whole: f64) -> String {
    format!("{:.1} %", if whole > 0.0 { 100.0 * part / whole } else { 0.0 })
}
