//! The live page of the book, in a browser: golden bits, keys, times, size, screens.

use std::fs;
use std::path::PathBuf;

use anyhow::{Context, Result, ensure};

use crate::browser::Browser;
use crate::metadata::Metadata;
use crate::web::{GOLDEN, golden};

/// All that the page loads, at most \[bytes\].
const MOST_BYTES: u64 = 1_000_000;
/// A page is redrawn after so long at most \[ms\], in steps of 10 ms and of 1 ms; the best of some
/// times: a machine that builds something else meanwhile is no fault of the page.
const MOST_MS: [f64; 2] = [200.0, 1000.0];
const TIMES: u32 = 5;
/// A phone held upright.
const NARROW: u32 = 390;

/// Builds the book and looks at the page in a browser.
pub fn live() -> Result<()> {
    crate::book::build()?;
    let target = Metadata::load()?.target_directory()?;
    let out = target.join("xtask-live");
    if out.exists() {
        fs::remove_dir_all(&out).with_context(|| out.display().to_string())?;
    }
    fs::create_dir_all(&out)?;
    let browser = Browser::start(&out.join("profile"))?;
    let mut page = Page { browser, file: target.join("book/live.html"), out };
    page.open(1280, false)?;
    page.has_golden_bits()?;
    page.hears_keys()?;
    page.is_quick()?;
    page.follows_haste()?;
    page.is_small()?;
    page.fits()?;
    let complaints = page.browser.complaints();
    ensure!(complaints.is_empty(), "the page complains: {complaints:?}");
    Ok(())
}

/// The first run is drawn in steps of 1 ms.
pub const FIRST_SHOWN: &str = "document.getElementById('live-plant')?.dataset.shown === '1 1'";

/// The page in a browser.
struct Page {
    browser: Browser,
    file: PathBuf,
    out: PathBuf,
}

impl Page {
    /// Opens it and waits for its first run.
    fn open(&mut self, width: u32, dark: bool) -> Result<()> {
        self.browser.screen(width, 900, 1.0, dark)?;
        self.browser.open(&self.file)?;
        self.browser.wait(FIRST_SHOWN)
    }

    /// Does something that changes the run, and waits until that is drawn in steps of 1 ms.
    fn change(&mut self, act: impl FnOnce(&mut Browser) -> Result<()>) -> Result<()> {
        let before = self.browser.text("document.getElementById('live-plant').dataset.shown")?;
        act(&mut self.browser)?;
        self.browser.wait(&format!(
            "(shown => shown !== {before:?} && shown.endsWith(' 1'))(document.getElementById('live-plant').dataset.shown)"
        ))
    }

    /// Sets a control as a hand would.
    fn set(&mut self, id: &str, value: &str) -> Result<()> {
        self.change(|browser| {
            browser.ask(&format!(
                "{{ const control = document.getElementById({id:?}); control.value = {value:?};
                   control.dispatchEvent(new Event('input', {{ bubbles: true }})); }}"
            ))?;
            Ok(())
        })
    }

    /// A figure by its name, as a number.
    fn figure(&mut self, name: &str) -> Result<f64> {
        let text = self.browser.text(&format!(
            "[...document.querySelectorAll('#figures dt')].find(dt => dt.textContent === {name:?}).nextSibling.textContent"
        ))?;
        let number = text.split(' ').next().unwrap_or_default().replace('−', "-");
        number.parse().with_context(|| format!("{name}: {text}"))
    }

    /// Each vehicle comes to the bits of the firmware, and a changed one does not.
    fn has_golden_bits(&mut self) -> Result<()> {
        let names =
            self.browser.ask("[...document.getElementById('car').options].map(o => o.text)")?;
        let names: Vec<String> = serde_json::from_value(names)?;
        let golden = golden()?;
        ensure!(names.len() == golden.len(), "{names:?} are not the vehicles of {GOLDEN}");
        for (name, hash) in golden {
            let number =
                names.iter().position(|found| *found == name).with_context(|| name.clone())?;
            // The first is shown already: from another one back to it.
            self.set("car", &((number + 1) % names.len()).to_string())?;
            self.set("car", &number.to_string())?;
            let shown = self.browser.text("document.getElementById('hash').textContent")?;
            ensure!(shown == hash, "{name}: {shown} on the page, {hash} in {GOLDEN}");
            let bits = self.browser.text("document.getElementById('live-plant').dataset.bits")?;
            ensure!(bits == "same", "{name}: the page calls its bits {bits:?}");
            println!("{name}: {shown}, the bits of the microcontroller");
        }
        self.set("car", "0")
    }

    /// Keys reach every control and move it, and turn no page of the book.
    fn hears_keys(&mut self) -> Result<()> {
        let hash = self.browser.text("document.getElementById('hash').textContent")?;
        let before = self.figure("Energy at the battery")?;
        self.browser.ask("document.getElementById('car').focus()")?;
        for wanted in ["cycle", "mass"] {
            self.browser.press("Tab", 9)?;
            let focused = self
                .browser
                .text("document.activeElement.id || document.activeElement.outerHTML")?;
            ensure!(focused == wanted, "Tab leads to {focused:?}, not to {wanted}");
        }
        for _ in 0..10 {
            self.change(|browser| browser.press("ArrowRight", 39))?;
        }
        let mass = self.browser.text("document.getElementById('mass').value")?;
        ensure!(mass == "110", "ten keys make {mass} % of the mass");
        let after = self.figure("Energy at the battery")?;
        ensure!(after > 1.01 * before, "more mass: {before} kWh become {after}");
        ensure!(
            hash != self.browser.text("document.getElementById('hash').textContent")?,
            "the same bits"
        );
        ensure!(
            self.browser.text("document.getElementById('live-plant').dataset.bits")?.is_empty(),
            "compared"
        );
        self.browser.ask("document.getElementById('speed').focus()")?;
        let whole = self.browser.text("document.getElementById('view')?.textContent")?;
        self.browser.press("+", 107)?;
        let zoomed = self.browser.text("document.getElementById('view')?.textContent")?;
        self.browser.press("ArrowRight", 39)?;
        let moved = self.browser.text("document.getElementById('view')?.textContent")?;
        ensure!(whole != zoomed && zoomed != moved, "{whole}, {zoomed}, {moved}");
        self.browser.press("0", 48)?;
        let title = self.browser.text("document.title")?;
        ensure!(title.starts_with("Live"), "the keys have turned to {title}");
        println!("keys: 10 % more mass, {before} kWh become {after}; {whole} becomes {zoomed}");
        Ok(())
    }

    /// The page says how long it takes to redraw, and that is short.
    fn is_quick(&mut self) -> Result<()> {
        let mut best = [f64::INFINITY; 2];
        for k in 0..TIMES {
            self.set("mass", &(100 + k).to_string())?;
            for (best, which) in best.iter_mut().zip(["coarseMs", "fineMs"]) {
                let ms = self
                    .browser
                    .text(&format!("document.getElementById('live-plant').dataset.{which}"))?;
                *best = best.min(ms.parse().with_context(|| format!("{which}: {ms:?}"))?);
            }
        }
        println!("redrawn after {} ms in steps of 10 ms, {} ms in steps of 1 ms", best[0], best[1]);
        ensure!(best[0] > 0.0 && best[0] < best[1], "no times");
        ensure!(best[0] < MOST_MS[0] && best[1] < MOST_MS[1], "more than {MOST_MS:?} ms");
        Ok(())
    }

    /// A slider that moves faster than the page can follow ends where it ends.
    fn follows_haste(&mut self) -> Result<()> {
        self.set("mass", "105")?;
        let hash = self.browser.text("document.getElementById('hash').textContent")?;
        let shown = self.browser.text("document.getElementById('live-plant').dataset.shown")?;
        let asked: u32 = shown.split(' ').next().unwrap_or_default().parse()?;
        self.browser.ask(
            "(async () => { const mass = document.getElementById('mass');
               for (let percent = 76; percent <= 105; percent++) {
                 mass.value = percent;
                 mass.dispatchEvent(new Event('input', { bubbles: true }));
                 await new Promise(requestAnimationFrame);
               } })()",
        )?;
        let last = asked + 30;
        self.browser
            .wait(&format!("document.getElementById('live-plant').dataset.shown === '{last} 1'"))?;
        let again = self.browser.text("document.getElementById('hash').textContent")?;
        ensure!(again == hash, "in haste {again}, else {hash}");
        Ok(())
    }

    /// All files that the page loads, itself with them.
    fn is_small(&self) -> Result<()> {
        let loaded = self.browser.loaded();
        let mut bytes = 0;
        for file in loaded.iter().filter_map(|address| address.strip_prefix("file://")) {
            bytes += fs::metadata(file).context(file.to_owned())?.len();
        }
        println!("{} files, {bytes} bytes", loaded.len());
        ensure!(loaded.iter().any(|name| name.ends_with("plant.js")), "no plant among {loaded:?}");
        ensure!(bytes < MOST_BYTES, "the page loads {bytes} bytes, more than {MOST_BYTES}");
        Ok(())
    }

    /// Wide or narrow, light or dark: nothing sticks out, and the plots take the theme's colours.
    fn fits(&mut self) -> Result<()> {
        let mut colours = Vec::new();
        for (width, dark) in [(1280, false), (1280, true), (NARROW, false), (NARROW, true)] {
            self.open(width, dark)?;
            // The book cuts off what is too wide.
            let right =
                "Math.max(...[...document.querySelectorAll('#live-plant, #live-plant *')].map(
                element => Math.ceil(element.getBoundingClientRect().right)))";
            let right = self.browser.ask(right)?.as_u64().context("no page")?;
            ensure!(right <= u64::from(width), "{right} pixels on a screen of {width}");
            let style =
                "getComputedStyle(document.documentElement).getPropertyValue('--simulated-0')";
            colours.push(self.browser.text(style)?);
            let scheme = if dark { "dark" } else { "light" };
            self.browser.picture(&self.out.join(format!("{width}-{scheme}.png")), true)?;
        }
        ensure!(colours[0] != colours[1] && colours[..2] == colours[2..], "colours: {colours:?}");
        println!("pictures of it lie in {}", self.out.display());
        Ok(())
    }
}
