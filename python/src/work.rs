//! Work that holds neither Python's lock nor Ctrl-C back.

use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::thread;
use std::time::Duration;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use voltstep::simulate::progress::Progress;

/// Ctrl-C is answered within this.
const PATIENCE: Duration = Duration::from_millis(50);

/// What the work says.
enum Message {
    At(usize, usize),
    Stage(String),
    Done,
}

/// Through which the work says how far it is, and learns that it is to end.
pub struct Teller {
    told: Sender<Message>,
    stopped: AtomicBool,
}

/// What ends a run from within: its loop asks nobody whether to go on.
struct Stopped;

impl Teller {
    /// Fails where the work is to end.
    pub fn go_on(&self) -> anyhow::Result<()> {
        anyhow::ensure!(!self.stopped.load(Ordering::Relaxed), "interrupted");
        Ok(())
    }

    /// So much is done.
    pub fn tell(&self, done: usize, total: usize) {
        self.say(Message::At(done, total));
    }

    /// What is being done; fails where the work is to end.
    pub fn stage(&self, what: &str) -> anyhow::Result<()> {
        self.say(Message::Stage(what.to_owned()));
        self.go_on()
    }

    fn say(&self, message: Message) {
        // Whoever listened may have gone.
        let _ = self.told.send(message);
    }
}

impl Progress for Teller {
    fn at(&self, done: usize, total: usize, _what: &str) {
        if self.go_on().is_err() {
            resume_unwind(Box::new(Stopped));
        }
        self.tell(done, total);
    }
}

/// Runs work on a thread of its own while this one, with which Python answers signals, calls
/// `progress` and looks for Ctrl-C.
pub fn run<T: Send>(
    py: Python<'_>,
    progress: Option<Py<PyAny>>,
    work: impl FnOnce(&Teller) -> anyhow::Result<T> + Send,
) -> PyResult<T> {
    let (joined, interrupted) = py.detach(|| {
        let (told, said) = mpsc::channel();
        let teller = Teller { told: told.clone(), stopped: AtomicBool::new(false) };
        let mut interrupted = None;
        let joined = thread::scope(|scope| {
            let worker = scope.spawn(|| {
                let _done = Done(told);
                work(&teller)
            });
            loop {
                let message = said.recv_timeout(PATIENCE);
                if matches!(message, Ok(Message::Done) | Err(RecvTimeoutError::Disconnected)) {
                    return worker.join();
                }
                if interrupted.is_none()
                    && let Err(error) = Python::attach(|py| answer(py, &message, progress.as_ref()))
                {
                    interrupted = Some(error);
                    teller.stopped.store(true, Ordering::Relaxed);
                }
            }
        });
        (joined, interrupted)
    });
    if let Some(error) = interrupted {
        return Err(error);
    }
    match joined {
        Ok(result) => result.map_err(refused),
        Err(panic) => resume_unwind(panic),
    }
}

/// Looks for Ctrl-C and tells Python how far the work is.
fn answer<E>(
    py: Python<'_>,
    message: &Result<Message, E>,
    progress: Option<&Py<PyAny>>,
) -> PyResult<()> {
    py.check_signals()?;
    match (message, progress) {
        (Ok(Message::At(done, total)), Some(call)) => call.call1(py, (done, total)).map(drop),
        (Ok(Message::Stage(what)), Some(call)) => call.call1(py, (what,)).map(drop),
        _ => Ok(()),
    }
}

/// Says that the work is done, however it ended.
struct Done(Sender<Message>);

impl Drop for Done {
    fn drop(&mut self) {
        let _ = self.0.send(Message::Done);
    }
}

/// The words of the command.
pub fn refused(error: anyhow::Error) -> PyErr {
    PyValueError::new_err(format!("{error:#}"))
}
