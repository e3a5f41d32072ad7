//! The page of a chart in a real browser: it loads without an error and fetches nothing, its split moves, its points say
//! what they stand for.
//!
//! Needs Chrome, Chromium or Edge; where there is none the tests are skipped, unless `WAVETRACE_BROWSER_TESTS` is
//! `required`. With `WAVETRACE_SCREENSHOTS=DIR` they leave pictures of the pages in that folder.

mod common;

use common::meshes::repository;
use headless_chrome::browser::default_executable;
use headless_chrome::browser::tab::point::Point;
use headless_chrome::protocol::cdp::Emulation::{MediaFeature, SetDeviceMetricsOverride, SetEmulatedMedia};
use headless_chrome::protocol::cdp::Input::{DispatchMouseEvent, DispatchMouseEventTypeOption, MouseButton};
use headless_chrome::protocol::cdp::Network;
use headless_chrome::protocol::cdp::Page::CaptureScreenshotFormatOption;
use headless_chrome::protocol::cdp::types::Event;
use headless_chrome::{Browser, LaunchOptions, Tab};
use serde_json::Value;
use std::ffi::OsStr;
use std::fs;
use std::io::Cursor;
use std::path::Path;
use std::process::Command;
use std::sync::{Arc, Mutex};
use std::time::Duration;
use tempfile::TempDir;
use wavetrace::chart::{Gallery, Legend, Page, Picture, Row, Scale};
use wavetrace::output::{Metadata, png_of_rgb8};

/// Pixels across and down the window.
const WIDE: (u32, u32) = (1240, 900);
const NARROW: (u32, u32) = (390, 800);

/// A browser, if there is one.
fn browser() -> Option<Browser> {
    let path = match default_executable() {
        Ok(path) => path,
        Err(error) => {
            let required = std::env::var_os("WAVETRACE_BROWSER_TESTS").is_some_and(|v| v == "required");
            assert!(!required, "a browser is required: {error}");
            eprintln!("skipped: found no Chrome, Chromium or Edge ({error})");
            return None;
        }
    };
    let options = LaunchOptions::default_builder()
        .path(Some(path))
        // The sandbox of Chromium does not start as root, as in a container. The pages are our own.
        .sandbox(false)
        .window_size(Some(WIDE))
        .args(vec![OsStr::new("--hide-scrollbars")])
        .idle_browser_timeout(Duration::from_secs(120))
        .build()
        .unwrap();
    Some(Browser::new(options).unwrap())
}

/// A page that is open, and what the browser had to say.
struct Opened {
    tab: Arc<Tab>,
    events: Arc<Mutex<Vec<String>>>,
}

impl Opened {
    fn new(browser: &Browser, file: &Path) -> Self {
        let tab = browser.new_tab().unwrap();
        tab.set_default_timeout(Duration::from_secs(60));
        let events = Arc::new(Mutex::new(Vec::new()));
        let (log, own) = (Arc::clone(&events), format!("file://{}", file.display()));
        let listener = move |event: &Event| {
            let text = match event {
                Event::RuntimeExceptionThrown(e) => format!("exception: {:?}", e.params.exception_details),
                Event::RuntimeConsoleAPICalled(e) => format!("console: {:?}", e.params.args),
                Event::LogEntryAdded(e) => format!("log: {}", e.params.entry.text),
                Event::NetworkRequestWillBeSent(e) => {
                    let url = &e.params.request.url;
                    if url.starts_with("data:") || *url == own {
                        return;
                    }
                    format!("request: {url}")
                }
                _ => return,
            };
            log.lock().unwrap().push(text);
        };
        tab.add_event_listener(Arc::new(listener)).unwrap();
        tab.enable_log().unwrap();
        tab.enable_runtime().unwrap();
        tab.call_method(Network::Enable {
            max_total_buffer_size: None,
            max_resource_buffer_size: None,
            max_post_data_size: None,
            report_direct_socket_traffic: None,
            enable_durable_messages: None,
        })
        .unwrap();
        tab.navigate_to(&format!("file://{}", file.display())).unwrap().wait_until_navigated().unwrap();
        Self { tab, events }
    }
    fn is_silent(&self) {
        let events = self.events.lock().unwrap();
        assert!(events.is_empty(), "{events:?}");
    }
    /// What a script says.
    fn value(&self, script: &str) -> Value {
        self.tab.evaluate(script, false).unwrap().value.unwrap_or(Value::Null)
    }
    fn number(&self, script: &str) -> f64 {
        self.value(script).as_f64().unwrap_or_else(|| panic!("{script} is no number"))
    }
    /// Left, top, width and height in the window of the first element of a selector.
    fn place(&self, selector: &str) -> [f64; 4] {
        self.value(&format!("document.querySelector('{selector}').scrollIntoView({{block: 'center'}})"));
        ["left", "top", "width", "height"]
            .map(|side| self.number(&format!("document.querySelector('{selector}').getBoundingClientRect().{side}")))
    }
    fn mouse(&self, kind: DispatchMouseEventTypeOption, x: f64, y: f64, pressed: bool) {
        let button = (kind != DispatchMouseEventTypeOption::MouseMoved || pressed).then_some(MouseButton::Left);
        self.tab
            .call_method(DispatchMouseEvent {
                Type: kind,
                x,
                y,
                modifiers: None,
                timestamp: None,
                button,
                buttons: pressed.then_some(1),
                click_count: Some(1),
                force: None,
                tangential_pressure: None,
                tilt_x: None,
                tilt_y: None,
                twist: None,
                delta_x: None,
                delta_y: None,
                pointer_Type: None,
            })
            .unwrap();
    }
    /// Drags with the left button.
    fn drag(&self, from: (f64, f64), to: (f64, f64)) {
        self.mouse(DispatchMouseEventTypeOption::MouseMoved, from.0, from.1, false);
        self.mouse(DispatchMouseEventTypeOption::MousePressed, from.0, from.1, true);
        for step in [0.3, 0.7, 1.0] {
            let along = |from: f64, to: f64| from + step * (to - from);
            self.mouse(DispatchMouseEventTypeOption::MouseMoved, along(from.0, to.0), along(from.1, to.1), true);
        }
        self.mouse(DispatchMouseEventTypeOption::MouseReleased, to.0, to.1, false);
        // Without the button, the split stays.
        self.mouse(DispatchMouseEventTypeOption::MouseMoved, from.0, from.1, false);
    }
    /// The window as pixels across, and their colours.
    fn screenshot(&self, name: &str) -> (usize, Vec<[u8; 3]>) {
        let bytes = self.tab.capture_screenshot(CaptureScreenshotFormatOption::Png, None, None, true).unwrap();
        keep(name, &bytes);
        let mut reader = png::Decoder::new(Cursor::new(bytes)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut pixels).unwrap();
        let samples = info.color_type.samples();
        (info.width as usize, pixels.chunks(samples).map(|p| [p[0], p[1], p[2]]).collect())
    }
    /// A picture of the whole page, for people.
    fn portrait(&self, name: &str, (width, height): (u32, u32), scheme: &str) {
        let features = Some(vec![MediaFeature { name: "prefers-color-scheme".into(), value: scheme.into() }]);
        self.tab.call_method(SetEmulatedMedia { media: None, features }).unwrap();
        self.window(width, height);
        let all = self.number("document.documentElement.scrollHeight") as u32;
        self.window(width, all.clamp(height, 12_000));
        let (across, pixels) = self.screenshot(name);
        assert!(across > 0 && pixels.iter().any(|&p| p != pixels[0]), "{name} is blank");
        let corner = pixels[0];
        assert_eq!(corner[0] > 128, scheme == "light", "{name}: {corner:?}");
        // Nothing sticks out to the right.
        assert!(self.number("document.documentElement.scrollWidth") <= f64::from(width), "{name} is too wide");
        self.window(WIDE.0, WIDE.1);
    }
    fn window(&self, width: u32, height: u32) {
        self.tab
            .call_method(SetDeviceMetricsOverride {
                width,
                height,
                device_scale_factor: 1.0,
                mobile: false,
                scale: None,
                screen_width: None,
                screen_height: None,
                position_x: None,
                position_y: None,
                dont_set_visible_size: None,
                screen_orientation: None,
                viewport: None,
                display_feature: None,
                device_posture: None,
            })
            .unwrap();
    }
}

fn keep(name: &str, bytes: &[u8]) {
    if let Some(folder) = std::env::var_os("WAVETRACE_SCREENSHOTS") {
        fs::create_dir_all(&folder).unwrap();
        fs::write(Path::new(&folder).join(name).with_extension("png"), bytes).unwrap();
    }
}

/// A picture of one colour.
fn flat(colour: [u8; 3]) -> Vec<u8> {
    png_of_rgb8(40, 20, &colour.repeat(800), &Metadata::default()).unwrap()
}

/// A page of fixed rows and pictures: two series, and one of another program.
fn fixed() -> Page {
    let row = |label: &str, spp: u64, seed: u64, seconds: f64, relmse: f64| Row {
        scene: "room".to_owned(),
        label: label.to_owned(),
        spp,
        seed: Some(seed),
        seconds,
        relmse,
        relmse_trimmed: Some(relmse / 2.0),
        mse: None,
        flip: Some(relmse.sqrt().min(1.0)),
    };
    let mut rows = Vec::new();
    for seed in 1..=3 {
        for spp in [1_u64, 4, 16, 64] {
            let (n, jitter) = (spp as f64, 1.0 + 0.1 * (seed as f64 - 2.0));
            rows.push(row("mis xoshiro", spp, seed, 0.05 * n, 0.8 / n * jitter));
            rows.push(row("mis sobol", spp, seed, 0.06 * n, 0.7 / n.powf(1.2) * jitter));
            rows.push(row("other", spp, seed, 0.2 * n, 0.5 / n * jitter));
        }
    }
    let picture = |label: &str, colour, heat| Picture {
        label: label.to_owned(),
        note: "relMSE 0.0125".to_owned(),
        picture: flat(colour),
        heat: flat(heat),
    };
    let gallery = Gallery {
        scene: "room".to_owned(),
        width: 40,
        height: 20,
        caption: "64 samples per pixel, seed 1".to_owned(),
        pictures: vec![picture("mis xoshiro", [255, 0, 0], [60, 0, 0]), picture("mis sobol", [0, 255, 0], [0, 60, 0])],
        reference: Some(flat([0, 0, 255])),
        scale: Some(Scale { colours: flat([120; 3]), low: "10⁻⁴".to_owned(), high: "1".to_owned() }),
    };
    Page {
        title: "Error of room".to_owned(),
        unfinished: Some("1 render is missing".to_owned()),
        rows,
        legend: Legend::new(["mis xoshiro", "mis sobol"].map(str::to_owned), ["other".to_owned()]),
        galleries: vec![gallery],
        facts: vec![("processor".to_owned(), "one that exists".to_owned())],
        command: "wavetrace chart room.json -o charts".to_owned(),
    }
}

fn saved(page: &Page) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("index.html"), page.html()).unwrap();
    folder
}

#[test]
fn the_split_moves_by_mouse_and_by_keys() {
    let Some(browser) = browser() else { return };
    let folder = saved(&fixed());
    let page = Opened::new(&browser, &folder.path().join("index.html"));
    let now = || page.number("Number(document.querySelector('.handle').getAttribute('aria-valuenow'))");
    assert_eq!(now(), 50.0);
    let [left, top, width, height] = page.place(".split");
    let at = |share: f64| (left + share * width, top + 0.25 * height);
    // What is left and right of the line, as it is on the screen.
    let colours = || {
        let (across, pixels) = page.screenshot("split");
        [0.1, 0.4, 0.6, 0.9].map(|share| {
            let (x, y) = at(share);
            pixels[y as usize * across + x as usize]
        })
    };
    let (red, blue) = ([255, 0, 0], [0, 0, 255]);
    assert_eq!(colours(), [red, red, blue, blue], "the first series left, the reference right");
    page.drag(at(0.5), at(0.25));
    assert_eq!(now(), 25.0);
    assert_eq!(colours(), [red, blue, blue, blue]);
    page.drag(at(0.25), at(0.75));
    assert_eq!(now(), 75.0);
    assert_eq!(colours(), [red, red, red, blue]);
    page.drag(at(0.75), (left + width + 200.0, top + 0.25 * height));
    assert_eq!(now(), 100.0, "a drag may leave the picture");
    // The handle has the focus: keys move it on.
    for (key, expected) in [("ArrowLeft", 99.0), ("PageDown", 89.0), ("Home", 0.0), ("ArrowLeft", 0.0), ("End", 100.0)]
    {
        page.tab.press_key(key).unwrap();
        assert_eq!(now(), expected, "{key}");
    }
    // Another picture on the left.
    page.value(
        "{ const left = document.querySelector('select'); left.selectedIndex = 1; left.dispatchEvent(new Event('change')); }",
    );
    assert_eq!(colours()[0], [0, 255, 0]);
    page.is_silent();
}

#[test]
fn points_say_what_they_stand_for() {
    let Some(browser) = browser() else { return };
    let folder = saved(&fixed());
    let page = Opened::new(&browser, &folder.path().join("index.html"));
    let tip =
        || page.value("document.getElementById('tip').hidden ? null : document.getElementById('tip').textContent");
    assert_eq!(tip(), Value::Null);
    assert_eq!(page.number("document.querySelectorAll('.panels:not([hidden]) .point').length"), 24.0);
    // The second point of the first line: 4 samples, in 0.2 s, with a median of 0.2.
    let [x, y, w, h] = page.place(".panels .line:nth-of-type(1) .point:nth-of-type(2) circle");
    page.tab.move_mouse_to_point(Point { x: x + w / 2.0, y: y + h / 2.0 }).unwrap();
    let expected = "mis xoshiro\n4 samples per pixel, 3 renders\n0.200 s\nrelMSE 0.200 (0.184 to 0.216)";
    assert_eq!(tip(), expected);
    page.screenshot("tooltip");
    let [tip_x, tip_y, tip_w, tip_h] = page.place("#tip");
    assert!(tip_x >= 0.0 && tip_y >= 0.0 && tip_w > 50.0 && tip_h > 50.0);
    page.tab.move_mouse_to_point(Point { x: 2.0, y: 2.0 }).unwrap();
    assert_eq!(tip(), Value::Null);
    // Focus shows it too; arrows go on.
    page.value("document.querySelector('.panels .point').focus()");
    assert!(tip().as_str().unwrap().starts_with("mis xoshiro\n1 sample per pixel"), "{}", tip());
    for (key, start) in [
        ("ArrowRight", "mis xoshiro\n4 samples"),
        ("ArrowDown", "mis sobol\n4 samples"),
        ("ArrowDown", "other\n4 samples"),
        ("ArrowDown", "mis xoshiro\n4 samples"),
        ("ArrowLeft", "mis xoshiro\n1 sample "),
        ("ArrowLeft", "mis xoshiro\n1 sample "),
    ] {
        page.tab.press_key(key).unwrap();
        assert!(tip().as_str().unwrap().starts_with(start), "{key}: {}", tip());
    }
    page.tab.press_key("Escape").unwrap();
    assert_eq!(tip(), Value::Null);
    // One stop of the tab key in each panel.
    assert_eq!(page.number("document.querySelectorAll('.panels:not([hidden]) .point[tabindex=\"0\"]').length"), 2.0);
    // Another error: other panels.
    page.value("document.querySelector('[name=metric][value=\"1\"]').click()");
    assert_eq!(page.number("document.querySelectorAll('.panels:not([hidden])').length"), 1.0);
    let shown = page.value("document.querySelector('.panels:not([hidden])').textContent");
    assert!(shown.as_str().unwrap().contains("relMSE without the worst 0.1 %"), "{shown}");
    page.is_silent();
}

#[test]
fn the_page_of_fixed_rows_is_fit_to_be_seen() {
    let Some(browser) = browser() else { return };
    let folder = saved(&fixed());
    let page = Opened::new(&browser, &folder.path().join("index.html"));
    for (name, size) in [("wide", WIDE), ("narrow", NARROW)] {
        for scheme in ["light", "dark"] {
            page.portrait(&format!("fixed-{name}-{scheme}"), size, scheme);
        }
    }
    page.is_silent();
}

#[test]
fn the_page_of_a_sweep_loads_and_shows_what_was_measured() {
    let Some(browser) = browser() else { return };
    let folder = tempfile::tempdir().unwrap();
    let scene = repository("scenes/cornell.json");
    let status = Command::new(env!("CARGO_BIN_EXE_wavetrace"))
        .arg("chart")
        .arg(&scene)
        .args(["--size", "48x48", "--spp", "1,4,16", "--seeds", "3", "--methods", "path,mis", "--quiet", "-o"])
        .arg(folder.path())
        .status();
    assert!(status.unwrap().success());
    let page = Opened::new(&browser, &folder.path().join("index.html"));
    // Two panels of four series with three points each.
    assert_eq!(page.number("document.querySelectorAll('.panels:not([hidden]) .point').length"), 24.0);
    assert_eq!(page.value("[...document.images].every((image) => image.complete && image.naturalWidth > 0)"), true);
    // Pictures, heat maps and reference once each, two of them again in the split, and the colours.
    assert_eq!(page.number("document.images.length"), 4.0 * 2.0 + 1.0 + 2.0 + 1.0);
    let rows = wavetrace::chart::row::read(&folder.path().join("chart.csv")).unwrap();
    let of_curve = |row: &&Row| row.label == "mis sobol" && row.spp == 16;
    let mut errors: Vec<f64> = rows.iter().filter(of_curve).map(|row| row.relmse).collect();
    errors.sort_by(f64::total_cmp);
    let tips = page.value("[...document.querySelectorAll('.point')].map((point) => point.dataset.tip).join('\\n\\n')");
    let expected = format!("relMSE {}", wavetrace::chart::number::figure(errors[1]));
    let tips = tips.as_str().unwrap().to_owned();
    let tip = tips.split("\n\n").find(|tip| tip.starts_with("mis sobol\n16 samples")).unwrap();
    assert!(tip.contains(&expected), "{expected} in {tip}");
    for (name, size) in [("wide", WIDE), ("narrow", NARROW)] {
        for scheme in ["light", "dark"] {
            page.portrait(&format!("sweep-{name}-{scheme}"), size, scheme);
        }
    }
    page.is_silent();
}

/// Runs the program in a folder, which it leaves pages in.
fn run(folder: &TempDir, args: &str) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_wavetrace"));
    let ran = command.current_dir(folder.path()).args(args.split_whitespace()).output().unwrap();
    assert!(ran.status.success(), "{args}: {}", String::from_utf8_lossy(&ran.stderr));
}

impl Opened {
    /// The tip that shows while the pointer is on the first element of a selector.
    fn tip_on(&self, selector: &str) -> String {
        let [x, y, w, h] = self.place(selector);
        self.tab.move_mouse_to_point(Point { x: x + w / 2.0, y: y + h / 2.0 }).unwrap();
        let tip = self.value("document.getElementById('tip').hidden ? '' : document.getElementById('tip').textContent");
        tip.as_str().unwrap().to_owned()
    }
}

/// The page of a profile has all its drawings, and each tells its figures.
#[test]
fn a_profile_shows_its_figures() {
    let Some(browser) = browser() else { return };
    let folder = tempfile::tempdir().unwrap();
    let scene = repository("scenes/demo6.json");
    run(&folder, &format!("profile {} --spp 2 --size 64x48 -o profile -q", scene.display()));
    let page = Opened::new(&browser, &folder.path().join("profile/index.html"));
    let names = page.value("[...document.querySelectorAll('section h2')].map((h) => h.textContent).join()");
    assert_eq!(
        names,
        "Stages,Time by bounces,Lanes in use,Limits of the machine,Timeline,Hardware counters,Memory,Plan,How to repeat this"
    );
    assert!(page.number("document.querySelectorAll('[aria-label=Stages] tbody tr').length") >= 10.0);
    for (section, lines) in
        [("Time by bounces", " rows, "), ("Lanes in use", " % of lanes hold a row"), ("Limits of the machine", " GB/s")]
    {
        let points = page.number(&format!("document.querySelectorAll('[aria-label=\"{section}\"] .point').length"));
        let tip = page.tip_on(&format!("section[aria-label=\"{section}\"] .point"));
        assert!(points >= 2.0 && tip.contains(lines), "{section}: {points} points, {tip:?}");
    }
    let spans = "[aria-label=\"What the workers did\"] .point";
    assert!(page.number(&format!("document.querySelectorAll('{spans}').length")) >= 10.0);
    assert!(page.tip_on(&format!("{spans} rect")).contains(" ms from "));
    // Counted, or told that there is nothing to count with.
    let counters = page.value("document.querySelector('[aria-label=\"Hardware counters\"]').textContent");
    let counters = counters.as_str().unwrap();
    assert!(counters.contains("instructions/row") || counters.contains("this system gives none: "), "{counters}");
    let memory = page.value("document.querySelector('[aria-label=Memory] table').textContent");
    for part in ["scene: corners", "tree: nodes", "waves: path.throughput", "film: sums"] {
        assert!(memory.as_str().unwrap().contains(part), "{part} in {memory}");
    }
    assert!(page.value("document.querySelector('pre').textContent").as_str().unwrap().contains("+ generate"));
    page.portrait("profile", WIDE, "light");
    page.portrait("profile-dark", WIDE, "dark");
    page.portrait("profile-narrow", NARROW, "light");
    page.is_silent();
}

/// The page of a sweep: a curve over one knob, a map of two.
#[test]
fn a_sweep_shows_its_figures() {
    let Some(browser) = browser() else { return };
    let folder = tempfile::tempdir().unwrap();
    let scene = repository("scenes/cornell.json");
    let sweep = format!("bench sweep --scene {} --size 16x16 --spp 1 --repeats 1 -q", scene.display());
    run(&folder, &format!("{sweep} --vary wave=64..256 -o curve"));
    run(&folder, &format!("{sweep} --vary wave=64,128 --vary bvh=fast,balanced,best -o map"));
    for (name, points, tip) in [("curve", 3.0, "wave 64\n"), ("map", 6.0, "wave 64\nbvh fast\n")] {
        let page = Opened::new(&browser, &folder.path().join(name).join("index.html"));
        assert_eq!(page.number("document.querySelectorAll('.point').length"), points, "{name}");
        let shown = page.tip_on(".point circle");
        assert!(shown.starts_with(tip) && shown.contains(" Mrays/s, spread "), "{name}: {shown:?}");
        page.portrait(&format!("sweep-{name}"), WIDE, "light");
        page.portrait(&format!("sweep-{name}-dark"), WIDE, "dark");
        page.portrait(&format!("sweep-{name}-narrow"), NARROW, "light");
        page.is_silent();
    }
}
