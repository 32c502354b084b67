//! Reports as a browser sees them: Chromium without a screen.

use std::path::Path;
use std::process::{Command, Stdio};

/// Names under which it is installed.
const NAMES: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];

/// A browser that is installed.
pub struct Browser(&'static str);

/// What came of a page.
pub struct Seen {
    /// The page after its scripts have run.
    pub dom: String,
    /// What was written to the console: errors, and what the page was not allowed to do.
    pub console: Vec<String>,
}

impl Browser {
    /// The one that is installed; without one, says so and gives none.
    pub fn find() -> Option<Self> {
        let starts = |name: &&&str| {
            let mut command = Command::new(name);
            command.arg("--version").stdout(Stdio::null()).stderr(Stdio::null());
            command.status().is_ok_and(|status| status.success())
        };
        let found = NAMES.iter().find(starts);
        if found.is_none() {
            // Not by a macro: the test runner keeps to itself what a test that passes prints.
            let told = "SKIPPED reports in a browser: no Chromium is installed\n";
            let _ = std::io::Write::write_all(&mut std::io::stderr(), told.as_bytes());
        }
        found.map(|name| Self(name))
    }

    /// Opens a page at a fragment of it, with further arguments.
    pub fn open(&self, page: &Path, fragment: &str, more: &[&str]) -> Seen {
        let profile = tempfile::tempdir().unwrap();
        let output = Command::new(self.0)
            .args(["--headless", "--no-sandbox", "--disable-gpu", "--virtual-time-budget=10000"])
            .args(["--window-size=1280,900", "--enable-logging=stderr", "--dump-dom"])
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .args(more)
            .arg(format!("file://{}{fragment}", page.canonicalize().unwrap().display()))
            .output()
            .unwrap();
        let text = |bytes| String::from_utf8_lossy(bytes).into_owned();
        let (dom, said) = (text(&output.stdout), text(&output.stderr));
        assert!(dom.contains("</html>"), "no page: {said}");
        let console = said.lines().filter(|l| l.contains(":CONSOLE")).map(str::to_owned).collect();
        Seen { dom, console }
    }
}

impl Seen {
    /// Its scripts ran to their end, without a word on the console.
    #[track_caller]
    pub fn is_sound(&self) {
        assert!(self.console.is_empty(), "{:?}", self.console);
        let head = self.dom.split("<head>").next().unwrap();
        assert!(head.contains("data-ready=\"yes\""), "{head}");
    }

    /// The texts of the elements that begin so, up to the next tag.
    pub fn texts(&self, begin: &str) -> Vec<String> {
        let after = self.dom.split(begin).skip(1);
        let texts = after.filter_map(|rest| rest.split_once('>')?.1.split('<').next());
        texts.map(|t| t.replace("&amp;", "&")).collect()
    }
}
