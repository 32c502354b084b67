//! The reports: what is in them, what a browser makes of them.

use std::fs;

use crate::browser::{Browser, Seen};
use crate::{Sandbox, TRIP};

/// The most that a report of a cycle may take, and one of the longest trip \[bytes\].
const CYCLE_BYTES: usize = 1_000_000;
const TRIP_BYTES: usize = 4_000_000;

/// Put into a page, tells what it came to at the end of the page.
fn with_script(html: &str, script: &str) -> String {
    let script = format!("<script>{{{script}}}</script>\n</body>");
    assert_eq!(html.matches("</body>").count(), 1);
    html.replace("</body>", &script)
}

/// Nothing leads out of a page: no address but those of its text, nothing that is fetched.
#[track_caller]
fn stands_alone(html: &str) {
    assert!(html.contains("content=\"default-src 'none'; style-src 'unsafe-inline'"));
    let without_scripts: String =
        html.split("<script").map(|part| part.split("</script>").last().unwrap()).collect();
    // Text has no bare brackets.
    for tag in without_scripts.split('<').skip(1).map(|tag| tag.split('>').next().unwrap()) {
        for fetched in [" src=", "url(", "@import", "refresh"] {
            assert!(!tag.contains(fetched), "{fetched} in {tag}");
        }
        for fetching in ["link", "img", "iframe", "object", "embed"] {
            assert!(!tag.starts_with(fetching), "{tag}");
        }
    }
    for part in without_scripts.split("href=\"").skip(1) {
        let address = part.split('"').next().unwrap();
        assert!(address.starts_with('#') || !address.contains(':'), "{address}");
    }
}

#[test]
fn the_report_of_a_cycle_is_small_alone_and_always_the_same() {
    let sandbox = Sandbox::new();
    for folder in ["one", "two"] {
        sandbox.succeed(&["replay", "udds", "--out", folder]);
    }
    let html = sandbox.read("one/report.html");
    assert!(html == sandbox.read("two/report.html"), "two runs, two reports");
    assert!(html.len() <= CYCLE_BYTES, "{} bytes", html.len());
    stands_alone(&html);
    for part in [
        "<td>consumption [Wh/km]</td>",
        "<figure class=\"plot\" tabindex=\"0\" aria-label=\"Motor torque over time\">",
        "class=\"sankey\"",
        "<td>rolling</td>",
        // Parameters beside their sources, those of the battery too.
        "<td><code>frontal_area_m2</code></td><td><code>2.38</code></td><td>[B]</td>",
        "<summary>Battery bmw-i3-60ah</summary>",
        "prefers-color-scheme: dark",
        "MIT License",
    ] {
        assert!(html.contains(part), "no {part}");
    }
}

#[test]
fn what_falls_between_two_rows_is_in_trace_and_report() {
    let sandbox = Sandbox::new();
    sandbox.succeed(&["replay", "udds", "--vehicle", "epowertrain-udds", "--out", "out"]);
    let summary: serde_json::Value =
        serde_json::from_str(&sandbox.read("out/summary.json")).unwrap();
    let torque =
        ["min", "max"].map(|end| summary[format!("motor_torque_{end}_nm")].as_f64().unwrap());
    let text = sandbox.read("out/trace.csv");
    let place =
        |name: &str| text.lines().next().unwrap().split(',').position(|c| c == name).unwrap();
    let column = |name: &str| -> Vec<f64> {
        let place = place(name);
        text.lines().skip(1).map(|l| l.split(',').nth(place).unwrap().parse().unwrap()).collect()
    };
    let least = |values: Vec<f64>| values.into_iter().fold(f64::MAX, f64::min);
    let most = |values: Vec<f64>| values.into_iter().fold(f64::MIN, f64::max);
    assert!((least(column("motor_torque_min_nm")) - torque[0]).abs() < 1e-2);
    assert!((most(column("motor_torque_max_nm")) - torque[1]).abs() < 1e-2);
    // The rows themselves do not have them: it is a test of something.
    assert!(most(column("motor_torque_nm")) < 0.7 * torque[1]);

    let Some(browser) = Browser::find() else { return };
    let html = sandbox.read("out/report.html");
    // The highest pixel of the line's colour in the whole view of the second plot, as a share.
    let script = "
        setTimeout(() => {
            const canvas = document.querySelectorAll('figure.plot')[1].querySelector('canvas');
            const { width, height } = canvas;
            const pixels = canvas.getContext('2d').getImageData(0, 0, width, height).data;
            let top = height, bottom = 0;
            for (let i = 0; i < pixels.length; i += 4) {
                const [r, , b, a] = pixels.slice(i, i + 4);
                if (a > 60 && b > r + 60) {
                    const y = Math.floor(i / 4 / width);
                    top = Math.min(top, y);
                    bottom = Math.max(bottom, y);
                }
            }
            document.body.dataset.drawn = `${top} ${bottom} ${height}`;
        }, 100);";
    sandbox.write("out/pixels.html", with_script(&html, script));
    let seen = browser.open(&sandbox.path().join("out/pixels.html"), "", &[]);
    seen.is_sound();
    let captions = seen.texts("<figcaption class=\"range\"");
    let said = format!("simulated −{:.1} … {:.0} N·m", -torque[0], torque[1]);
    assert!(captions[1].contains(&said), "{captions:?}: no {said}");
    let drawn = seen.dom.split("data-drawn=\"").nth(1).unwrap().split('"').next().unwrap();
    let drawn: Vec<f64> = drawn.split(' ').map(|n| n.parse().unwrap()).collect();
    // Of 210 px, 6 are above and 24 below; the range has 6 % of room at either end.
    let (top, bottom) = (drawn[0] / drawn[2], drawn[1] / drawn[2]);
    assert!(top < 0.11 && bottom > 0.80, "{drawn:?}");
}

#[test]
fn a_browser_zooms_by_address_keys_buttons_and_drag() {
    let Some(browser) = Browser::find() else { return };
    let sandbox = Sandbox::new();
    sandbox.succeed(&["replay", TRIP, "--out", "out"]);
    let page = sandbox.path().join("out/report.html");
    let html = sandbox.read("out/report.html");
    stands_alone(&html);

    let whole = browser.open(&page, "", &[]);
    whole.is_sound();
    assert_eq!(whole.texts("<output"), ["0:00 to 10:00"]);
    let part = browser.open(&page, "#t=120,240", &[]);
    part.is_sound();
    assert_eq!(part.texts("<output"), ["2:00.0 to 4:00.0"]);
    let captions = |seen: &Seen| seen.texts("<figcaption class=\"range\"");
    assert_eq!((captions(&whole).len(), captions(&part).len()), (5, 5));
    for (whole, part) in captions(&whole).iter().zip(captions(&part)) {
        assert!(part.contains("measured") && part.contains("difference"), "{part}");
        assert_ne!(*whole, part);
    }
    // Measured beside simulated, the difference below.
    assert_eq!(whole.dom.matches("<canvas").count(), 10);

    let script = "
        const view = () => document.getElementById('view').textContent;
        const seen = [];
        const figure = document.querySelector('figure.plot');
        const key = (key, more) => {
            figure.dispatchEvent(new KeyboardEvent('keydown', { key, bubbles: true, ...more }));
            seen.push(view());
        };
        const click = id => { document.getElementById(id).click(); seen.push(view()); };
        click('zoom-in'); click('left'); click('right'); click('zoom-out'); click('reset');
        key('+'); key('ArrowRight'); key('ArrowLeft'); key('End'); key('Home'); key('-'); key('+'); key('Escape');
        key('ArrowRight', { shiftKey: true });
        seen.push(figure.querySelector('.u-legend .u-value').textContent);
        const over = document.querySelector('.u-over');
        const { left, top, width } = over.getBoundingClientRect();
        const mouse = (target, type, share) => target.dispatchEvent(new MouseEvent(type, {
            clientX: left + share * width, clientY: top + 50, button: 0, buttons: 1, bubbles: true, view: window, movementX: 9 }));
        mouse(over, 'mouseenter', .25); mouse(over, 'mousemove', .25);
        mouse(over, 'mousedown', .25); mouse(over, 'mousemove', .5); mouse(over, 'mousemove', .75);
        mouse(document, 'mouseup', .75);
        seen.push(view());
        mouse(over, 'dblclick', .5);
        seen.push(view());
        document.body.dataset.seen = seen.join('|');";
    sandbox.write("out/driven.html", with_script(&html, script));
    let driven = browser.open(&sandbox.path().join("out/driven.html"), "", &[]);
    driven.is_sound();
    let seen = driven.dom.split("data-seen=\"").nth(1).unwrap().split('"').next().unwrap();
    let all = "0:00 to 10:00";
    let half = "2:30 to 7:30";
    let expected = [
        // Buttons.
        half,
        "0:00 to 5:00",
        half,
        all,
        all,
        // Keys.
        half,
        "3:30 to 8:30",
        half,
        "5:00 to 10:00",
        "0:00 to 5:00",
        all,
        half,
        all,
        // The reading cursor, from the middle one sample on.
        all,
        "5:00",
        // The mouse.
        half,
        all,
    ];
    assert_eq!(seen.split('|').collect::<Vec<_>>(), expected);

    let dark = with_script(
        &html,
        "document.body.dataset.paper = getComputedStyle(document.body).backgroundColor;",
    );
    sandbox.write("out/dark.html", dark);
    for (flags, paper) in
        [(&[][..], "rgb(255, 255, 255)"), (&["--force-dark-mode"], "rgb(20, 24, 28)")]
    {
        let seen = browser.open(&sandbox.path().join("out/dark.html"), "", flags);
        seen.is_sound();
        assert!(seen.dom.contains(&format!("data-paper=\"{paper}\"")), "{flags:?}");
    }

    // What the looks above would have noticed.
    for (wrong, words) in [
        ("throw new Error('broken');", "broken"),
        (
            "document.body.append(Object.assign(new Image(), { src: 'http://localhost:9/x.png' }));",
            "Content Security Policy",
        ),
    ] {
        sandbox.write("out/wrong.html", with_script(&html, wrong));
        let seen = browser.open(&sandbox.path().join("out/wrong.html"), "", &[]);
        assert!(seen.console.iter().any(|line| line.contains(words)), "{:?}", seen.console);
    }
}

/// Windows has no such names.
#[cfg(unix)]
#[test]
fn names_and_texts_are_text() {
    let sandbox = Sandbox::new();
    let name = "<img src=x onerror=console.error(1)>&\"'<script>console.error(2)<script>";
    let tricky = "</script><b>&";
    let vehicle = include_str!("../../data/vehicles/bmw-i3-60ah.toml");
    let vehicle = vehicle
        .replace("BMW i3 60 Ah:", tricky)
        .replace("\nmass_kg", "\n# </pre><script>console.error(3)</script>\nmass_kg");
    sandbox.write("car.toml", vehicle);
    let trip = format!("trips/{name}.csv");
    sandbox.write(&trip, fs::read(TRIP).unwrap());
    sandbox.succeed(&["replay", &trip, "--vehicle", "car.toml", "--out", "out"]);
    sandbox.succeed(&["validate", "--trips", "trips", "--vehicle", "car.toml", "--out", "all"]);
    let one = sandbox.path().join("out/report.html");
    let (overview, linked) = (
        sandbox.path().join("all/report.html"),
        sandbox.path().join("all/vehicle").join(format!("{name}.html")),
    );
    assert!(linked.exists());
    for page in [&one, &overview, &linked] {
        stands_alone(&fs::read_to_string(page).unwrap());
    }
    let Some(browser) = Browser::find() else { return };
    for page in [&one, &overview] {
        let seen = browser.open(page, "", &[]);
        seen.is_sound();
        assert_eq!(seen.dom.matches("<img").count(), 0);
    }
    // The link leads where the report is: a browser finds it.
    let follow = with_script(
        &fs::read_to_string(&overview).unwrap(),
        "const links = [...document.querySelectorAll('td a')].map(a => decodeURIComponent(a.getAttribute('href')));
         document.body.dataset.links = links.length + ' ' + (links[0] === 'vehicle/' + links[0].slice(8));
         document.body.dataset.first = links[0];",
    );
    sandbox.write("all/follow.html", follow);
    let seen = browser.open(&sandbox.path().join("all/follow.html"), "", &[]);
    let first = seen.dom.split("data-first=\"").nth(1).unwrap().split('"').next().unwrap();
    let first = first
        .replace("&quot;", "\"")
        .replace("&lt;", "<")
        .replace("&gt;", ">")
        .replace("&amp;", "&");
    assert!(sandbox.path().join("all").join(&first).exists(), "{first}");
}

#[test]
fn overviews_lead_to_each_and_sort() {
    let sandbox = Sandbox::new();
    for name in ["b", "a", "c"] {
        sandbox.write(&format!("trips/{name}.csv"), fs::read(TRIP).unwrap());
    }
    let said = sandbox.succeed(&["validate", "--trips", "trips", "--out", "trips-out"]);
    assert!(said.ends_with("report.html and summary.json are in trips-out\n"), "{said}");
    sandbox.succeed(&["soc", "trips", "--matrix", "--out", "soc-out", "--json"]);
    sandbox.succeed(&["bms", "--each", "150", "--hours", "0", "--out", "bms-out"]);
    let pages = ["trips-out", "soc-out", "bms-out"].map(|folder| format!("{folder}/report.html"));
    for page in &pages {
        let html = sandbox.read(page);
        stands_alone(&html);
        assert!(
            html.contains("class=\"histograms\"") && html.contains("class=\"sortable\""),
            "{page}"
        );
        let folder = page.split('/').next().unwrap();
        for link in html.split("<td><a href=\"").skip(1) {
            let link = link.split('"').next().unwrap().replace("%20", " ");
            assert!(sandbox.path().join(folder).join(&link).exists(), "{page}: {link}");
        }
    }
    let bms = sandbox.read(&pages[2]);
    for part in [">CellWireOpen</td>", "before harm [ms]", "why harmless", "id=\"kinds\""] {
        assert!(bms.contains(part), "{part}");
    }
    let links = |page: &str| sandbox.read(page).matches("<td><a href=").count();
    assert_eq!(pages.each_ref().map(|page| links(page)), [6, 36, 0]);

    let Some(browser) = Browser::find() else { return };
    let script = "
        const table = document.querySelector('table.sortable');
        const column = n => [...table.tBodies[0].rows].map(row => row.cells[n].textContent).join(',');
        const sort = n => table.tHead.rows[0].cells[n].querySelector('button').click();
        const seen = [];
        sort(0); seen.push(column(0)); sort(0); seen.push(column(0));
        seen.push(table.tHead.rows[0].cells[0].getAttribute('aria-sort'));
        document.body.dataset.seen = seen.join('|');";
    sandbox.write("trips-out/sorted.html", with_script(&sandbox.read(&pages[0]), script));
    let seen = browser.open(&sandbox.path().join("trips-out/sorted.html"), "", &[]);
    seen.is_sound();
    assert!(seen.dom.contains("data-seen=\"a,b,c|c,b,a|descending\""));
    for page in ["soc-out/report.html", "soc-out/runs/0001-a.html", "bms-out/report.html"] {
        browser.open(&sandbox.path().join(page), "", &[]).is_sound();
    }
}

#[test]
fn reports_of_experiments() {
    let sandbox = Sandbox::new();
    sandbox.succeed(&["experiment", "motor-step", "--out", "out"]);
    assert_eq!(sandbox.names("out"), crate::OUTPUTS);
    let html = sandbox.read("out/report.html");
    stands_alone(&html);
    assert!(html.len() <= CYCLE_BYTES && html.contains("<td class=\"pass\">pass</td>"));
    let Some(browser) = Browser::find() else { return };
    let seen = browser.open(&sandbox.path().join("out/report.html"), "#t=0.1,0.2", &[]);
    seen.is_sound();
    assert_eq!(seen.texts("<output"), ["0.1000 to 0.2000 s"]);
}

/// A folder that cannot be written into is found out before the run, and nothing is left.
#[test]
fn a_bad_folder_is_refused_before_the_run() {
    let sandbox = Sandbox::new();
    sandbox.write("file", "a file");
    sandbox.write("trips/a.csv", fs::read(TRIP).unwrap());
    let before = sandbox.everything();
    for args in [
        // Each of these runs would fail, or take long, if it came to it.
        &["validate", "--trips", "nowhere", "--out", "file"][..],
        &["soc", "--matrix", "--out", "file/under"],
        &["bms", "--out", "file"],
        &["experiment", "udds-energy", "--out", "file"],
    ] {
        let run = sandbox.run(args);
        assert_eq!(run.code, Some(2), "{args:?}");
        assert!(run.stderr.contains("exists and is not a directory"), "{args:?}: {}", run.stderr);
        assert_eq!(run.stderr.lines().count(), 1);
        assert!(sandbox.everything() == before);
    }
    let run = sandbox.run(&["validate", "--out", "out"]);
    assert_eq!(run.code, Some(2), "{}", run.stderr);
    // A run that fails leaves nothing of what it had written.
    sandbox.write("trips/z.csv", "time_s;nothing\n1;2\n");
    let before = sandbox.everything();
    assert_eq!(sandbox.run(&["validate", "--trips", "trips", "--out", "new/er"]).code, Some(2));
    let left: Vec<_> =
        sandbox.everything().into_keys().filter(|p| !before.contains_key(p)).collect();
    assert!(left.iter().all(|path| path.ends_with("new")), "{left:?}");
}

#[test]
fn the_longest_real_trip_stays_small() {
    let Some(data) = std::env::var_os("VOLTSTEP_DATA").filter(|v| !v.is_empty()) else {
        println!("SKIPPED: the real trips are not part of the project; set VOLTSTEP_DATA");
        return;
    };
    let trips = std::path::Path::new(&data).join("bmw-i3-trips");
    let files = fs::read_dir(trips).unwrap().map(|e| e.unwrap().path());
    let longest = files.filter(|p| p.extension().is_some_and(|e| e == "csv"));
    // Not all are UTF-8.
    let rows = |path: &std::path::PathBuf| fs::read(path).unwrap().split(|b| *b == b'\n').count();
    let longest = longest.max_by_key(rows).unwrap();
    let sandbox = Sandbox::new();
    sandbox.succeed(&["replay", longest.to_str().unwrap(), "--dt-ms", "10", "--out", "out"]);
    let bytes = sandbox.read("out/report.html").len();
    assert!(bytes <= TRIP_BYTES, "{bytes}");
}
