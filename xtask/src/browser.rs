//! Chromium without a screen, told what to do through its `DevTools` protocol: keys as from a keyboard, real
//! time, narrow and dark screens.

use std::collections::BTreeSet;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde_json::{Value, json};

/// What an answer or a state of the page may take at most.
const PATIENCE: Duration = Duration::from_mins(1);
/// How often a state of the page is asked for.
const PERIOD: Duration = Duration::from_millis(20);

/// A browser with one page.
pub struct Browser {
    process: Child,
    orders: ChildStdin,
    heard: Receiver<Value>,
    session: Option<String>,
    last: u32,
    complaints: Vec<String>,
    loaded: BTreeSet<String>,
}

impl Browser {
    /// Starts it with a profile of its own in a folder.
    pub fn start(profile: &Path) -> Result<Self> {
        // It listens on 3 and answers on 4; what it says by itself is for nobody.
        let mut process = Command::new("sh")
            .args(["-c", "exec chromium \"$@\" 3<&0 4>&1 </dev/null >/dev/null 2>&1", "chromium"])
            .args(["--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars"])
            .arg("--remote-debugging-pipe")
            .arg(format!("--user-data-dir={}", profile.display()))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()?;
        let orders = process.stdin.take().context("no pipe")?;
        let mut answers = BufReader::new(process.stdout.take().context("no pipe")?);
        let (told, heard) = channel();
        std::thread::spawn(move || {
            let mut message = Vec::new();
            while answers.read_until(0, &mut message).is_ok_and(|bytes| bytes > 0) {
                message.pop();
                let known = serde_json::from_slice(&message).is_ok_and(|v| told.send(v).is_ok());
                if !known {
                    break;
                }
                message.clear();
            }
        });
        let mut browser = Self {
            process,
            orders,
            heard,
            session: None,
            last: 0,
            complaints: Vec::new(),
            loaded: BTreeSet::new(),
        };
        let target = browser.order("Target.createTarget", json!({ "url": "about:blank" }))?;
        let target = json!({ "targetId": target["targetId"], "flatten": true });
        let session = browser.order("Target.attachToTarget", target)?["sessionId"].take();
        browser.session = Some(session.as_str().context("no session")?.to_owned());
        for domain in ["Page", "Runtime", "Log", "Network"] {
            browser.order(&format!("{domain}.enable"), json!({}))?;
        }
        // Keys go where the focus is, also where no window has it.
        browser.order("Emulation.setFocusEmulationEnabled", json!({ "enabled": true }))?;
        Ok(browser)
    }

    /// Gives an order and waits for what it answers.
    pub fn order(&mut self, method: &str, params: Value) -> Result<Value> {
        self.last += 1;
        let mut order = json!({ "id": self.last, "method": method, "params": params });
        if let Some(session) = &self.session {
            order["sessionId"] = session.as_str().into();
        }
        self.orders.write_all(format!("{order}\0").as_bytes()).context("Chromium has ended")?;
        loop {
            let mut message = self.heard.recv_timeout(PATIENCE).with_context(|| {
                format!("Chromium does not answer {method}; `cargo xtask setup` installs it")
            })?;
            if message["id"] == self.last {
                if !message["error"].is_null() {
                    bail!("Chromium refuses {method}: {}", message["error"]);
                }
                return Ok(message["result"].take());
            }
            self.listen(&message);
        }
    }

    /// Keeps errors, what was written to the console, and what was loaded.
    fn listen(&mut self, event: &Value) {
        let params = &event["params"];
        let complaint = match event["method"].as_str() {
            Some("Runtime.exceptionThrown") => &params["exceptionDetails"],
            Some("Runtime.consoleAPICalled") => &params["args"],
            Some("Log.entryAdded") => &params["entry"],
            Some("Network.requestWillBeSent") => {
                self.loaded.extend(params["request"]["url"].as_str().map(str::to_owned));
                return;
            }
            _ => return,
        };
        self.complaints.push(complaint.to_string());
    }

    /// Errors and words on the console so far.
    pub fn complaints(&self) -> &[String] {
        &self.complaints
    }

    /// The addresses of all that the page has loaded since it was opened, its own with them.
    pub fn loaded(&self) -> &BTreeSet<String> {
        &self.loaded
    }

    /// What an expression comes to on the page.
    pub fn ask(&mut self, expression: &str) -> Result<Value> {
        let params =
            json!({ "expression": expression, "returnByValue": true, "awaitPromise": true });
        let mut answer = self.order("Runtime.evaluate", params)?;
        if !answer["exceptionDetails"].is_null() {
            bail!("{expression}: {}", answer["exceptionDetails"]);
        }
        Ok(answer["result"]["value"].take())
    }

    /// The same as text; empty where it is none.
    pub fn text(&mut self, expression: &str) -> Result<String> {
        Ok(self.ask(expression)?.as_str().unwrap_or_default().to_owned())
    }

    /// Waits until an expression is true.
    pub fn wait(&mut self, expression: &str) -> Result<()> {
        let start = Instant::now();
        while self.ask(expression)? != Value::Bool(true) {
            if start.elapsed() > PATIENCE {
                bail!("never came true: {expression}; {:?}", self.complaints);
            }
            std::thread::sleep(PERIOD);
        }
        Ok(())
    }

    /// Opens a file and waits until it is there.
    pub fn open(&mut self, file: &Path) -> Result<()> {
        let url = format!("file://{}", file.display());
        self.loaded.clear();
        self.order("Page.navigate", json!({ "url": url }))?;
        self.wait(&format!("location.href === {url:?} && document.readyState === 'complete'"))
    }

    /// A key, as from a keyboard: its name, and its virtual code.
    pub fn press(&mut self, key: &str, code: u32) -> Result<()> {
        let text = if key.len() == 1 { key } else { "" };
        for kind in ["keyDown", "keyUp"] {
            let text = if kind == "keyDown" { text } else { "" };
            let params = json!({ "type": kind, "key": key, "code": key, "text": text,
                "windowsVirtualKeyCode": code, "nativeVirtualKeyCode": code });
            self.order("Input.dispatchKeyEvent", params)?;
        }
        Ok(())
    }

    /// The size of the screen, how many pixels of a picture one of it has, and whether it is dark.
    pub fn screen(&mut self, width: u32, height: u32, scale: f64, dark: bool) -> Result<()> {
        let size = json!({ "width": width, "height": height, "deviceScaleFactor": scale, "mobile": false });
        self.order("Emulation.setDeviceMetricsOverride", size)?;
        let scheme = if dark { "dark" } else { "light" };
        let media = json!({ "features": [{ "name": "prefers-color-scheme", "value": scheme }] });
        self.order("Emulation.setEmulatedMedia", media)?;
        Ok(())
    }

    /// What the page looks like as a PNG: from top to bottom, or as much as the screen holds.
    pub fn picture(&mut self, file: &Path, whole: bool) -> Result<()> {
        let params = json!({ "format": "png", "captureBeyondViewport": whole });
        let answer = self.order("Page.captureScreenshot", params)?;
        let bytes = BASE64_STANDARD.decode(answer["data"].as_str().context("no picture")?)?;
        std::fs::write(file, bytes).with_context(|| file.display().to_string())
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        self.session = None;
        let _ = self.order("Browser.close", json!({}));
        let _ = self.process.wait();
    }
}
