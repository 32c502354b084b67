//! How far a long run is, on a terminal: standard error, where it is one.

use std::sync::OnceLock;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use crate::simulate::progress::Progress;

/// How often a spinner moves.
const MOVES_EVERY: Duration = Duration::from_millis(100);

/// A bar, gone when this is dropped.
pub struct Bar {
    template: &'static str,
    after: Duration,
    started: Instant,
    shown: OnceLock<ProgressBar>,
}

impl Bar {
    /// For a run whose parts take equally long; shown once it has taken longer than `after`.
    pub fn new(after: Duration) -> Self {
        Self::with("{bar:40} {percent:>3} %  {eta} left", after)
    }

    /// For cases that have names, shown at once.
    pub fn of_cases() -> Self {
        Self::with("{bar:40} {pos} of {len} cases  {msg}", Duration::ZERO)
    }

    fn with(template: &'static str, after: Duration) -> Self {
        Self { template, after, started: Instant::now(), shown: OnceLock::new() }
    }
}

impl Progress for Bar {
    fn at(&self, done: usize, total: usize, what: &str) {
        if self.started.elapsed() < self.after {
            return;
        }
        let bar = self.shown.get_or_init(|| {
            let bar = ProgressBar::new(total as u64);
            match ProgressStyle::with_template(self.template) {
                Ok(style) => bar.with_style(style),
                Err(_) => bar,
            }
        });
        bar.set_message(what.to_owned());
        bar.set_position(done as u64);
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        if let Some(bar) = self.shown.get() {
            bar.finish_and_clear();
        }
    }
}

/// A spinner for work of unknown length, gone when this is dropped.
pub struct Spinner(ProgressBar);

impl Spinner {
    /// One that turns.
    pub fn new() -> Self {
        let bar = ProgressBar::new_spinner();
        if let Ok(style) = ProgressStyle::with_template("{spinner} {msg}, {elapsed}") {
            bar.set_style(style);
        }
        bar.enable_steady_tick(MOVES_EVERY);
        Self(bar)
    }

    /// Says what is being done.
    pub fn stage(&self, stage: &str) {
        self.0.set_message(stage.to_owned());
    }
}

impl Drop for Spinner {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
