//! How far a long run is, for whoever wants to see it.

/// Is told how far a long run is; from several threads where a run uses several.
pub trait Progress: Sync {
    /// `done` of `total` parts are done, the last of them `what`.
    fn at(&self, done: usize, total: usize, what: &str);
}

/// Nobody looks.
#[derive(Clone, Copy, Debug)]
pub struct Unseen;

impl Progress for Unseen {
    fn at(&self, _: usize, _: usize, _: &str) {}
}
