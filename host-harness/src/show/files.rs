//! Files that appear whole or not at all.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use anyhow::{Context, ensure};
use tempfile::{NamedTempFile, TempPath};

/// Whether `folder` can take these files, before anything is computed for them. Nothing is made.
///
/// # Errors
/// A file where the folder, or a folder where a file should be; no permission to write.
pub fn check(folder: &Path, names: &[&str]) -> anyhow::Result<()> {
    let context = || format!("writing into {}", folder.display());
    let mut there = folder;
    while !there.exists() {
        match there.parent() {
            Some(parent) if parent != Path::new("") => there = parent,
            _ => there = Path::new("."),
        }
    }
    ensure!(there.is_dir(), "{}: {} exists and is not a directory", context(), there.display());
    tempfile::tempfile_in(there).with_context(context)?;
    not_blocked(folder, names.iter().copied())
}

/// What would stop a later file must not leave an earlier one replaced.
fn not_blocked<'a>(folder: &Path, names: impl Iterator<Item = &'a str>) -> anyhow::Result<()> {
    for path in names.map(|name| folder.join(name)) {
        ensure!(!path.is_dir(), "writing {}: it is a directory", path.display());
    }
    Ok(())
}

/// Writes every file into `folder`: first all of them beside their places, then into place.
pub fn write_all(folder: &Path, files: &[(&str, Vec<u8>)]) -> anyhow::Result<()> {
    not_blocked(folder, files.iter().map(|(name, _)| *name))?;
    let stage = Stage::new(folder)?;
    for (name, content) in files {
        stage.put(name, content)?;
    }
    stage.publish()
}

/// Files that wait beside their places until all of them are there; gone with this unless published.
pub struct Stage {
    folder: PathBuf,
    /// Whether the folder is of this stage's making.
    made: bool,
    ready: Mutex<BTreeMap<String, TempPath>>,
}

impl Stage {
    /// In a folder, which is made where it is not there.
    pub fn new(folder: &Path) -> anyhow::Result<Self> {
        let made = !folder.exists();
        let context = || format!("writing into {}", folder.display());
        std::fs::create_dir_all(folder).with_context(context)?;
        Ok(Self { folder: folder.to_owned(), made, ready: Mutex::default() })
    }

    /// Adds a file; its name may lead through folders.
    pub fn put(&self, name: &str, content: &[u8]) -> anyhow::Result<()> {
        let context = || format!("writing into {}", self.folder.display());
        let mut file = NamedTempFile::new_in(&self.folder).with_context(context)?;
        file.write_all(content).with_context(context)?;
        readable_by_all(&file)?;
        let mut ready = self.ready.lock().unwrap_or_else(PoisonError::into_inner);
        let twice = ready.insert(name.to_owned(), file.into_temp_path()).is_some();
        ensure!(!twice, "two measurements would leave the same file, {name}");
        Ok(())
    }

    /// Moves all of them into place.
    pub fn publish(mut self) -> anyhow::Result<()> {
        let ready = std::mem::take(&mut self.ready);
        let ready = ready.into_inner().unwrap_or_else(PoisonError::into_inner);
        not_blocked(&self.folder, ready.keys().map(String::as_str))?;
        self.made = false;
        for (name, file) in ready {
            let path = self.folder.join(name);
            let context = || format!("writing {}", path.display());
            if let Some(parent) = path.parent() {
                std::fs::create_dir_all(parent).with_context(context)?;
            }
            file.persist(&path).map_err(|e| e.error).with_context(context)?;
        }
        Ok(())
    }
}

impl Drop for Stage {
    fn drop(&mut self) {
        if self.made {
            // Empty again once what waited in it is gone; one that is not stays.
            drop(std::mem::take(&mut self.ready));
            let _ = std::fs::remove_dir(&self.folder);
        }
    }
}

/// A temporary file is private; what it becomes is an ordinary file.
fn readable_by_all(file: &NamedTempFile) -> anyhow::Result<()> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        file.as_file().set_permissions(std::fs::Permissions::from_mode(0o644))?;
    }
    #[cfg(not(unix))]
    let _ = file;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn replaces_files_and_leaves_no_others() {
        let folder = tempfile::tempdir().unwrap();
        for text in ["one", "two"] {
            write_all(
                &folder.path().join("a/b"),
                &[("x.txt", text.into()), ("y.txt", b"y".into())],
            )
            .unwrap();
            let read = std::fs::read_to_string(folder.path().join("a/b/x.txt")).unwrap();
            assert_eq!(read, text);
        }
        assert_eq!(std::fs::read_dir(folder.path().join("a/b")).unwrap().count(), 2);
    }

    #[test]
    fn a_folder_is_looked_at_before_and_not_made() {
        let folder = tempfile::tempdir().unwrap();
        check(&folder.path().join("a/b"), &["x.txt"]).unwrap();
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
        write_all(folder.path(), &[("x.txt", b"old".into())]).unwrap();
        std::fs::create_dir(folder.path().join("y.txt")).unwrap();
        let refused =
            |at: &str, name: &str| check(&folder.path().join(at), &[name]).unwrap_err().to_string();
        assert!(refused("x.txt", "z.txt").contains("exists and is not a directory"));
        assert!(refused("x.txt/under", "z.txt").contains("exists and is not a directory"));
        assert!(refused("", "y.txt").ends_with("it is a directory"));
    }

    #[test]
    fn what_waits_is_gone_unless_published() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("out");
        let stage = Stage::new(&out).unwrap();
        stage.put("a/x.txt", b"x").unwrap();
        assert!(stage.put("a/x.txt", b"x").unwrap_err().to_string().contains("a/x.txt"));
        drop(stage);
        assert!(!out.exists());
        let stage = Stage::new(&out).unwrap();
        stage.put("a/x.txt", b"x").unwrap();
        stage.publish().unwrap();
        assert_eq!(std::fs::read(out.join("a/x.txt")).unwrap(), b"x");
        assert_eq!(std::fs::read_dir(&out).unwrap().count(), 1);
    }

    #[test]
    fn keeps_what_is_there_when_one_file_cannot_be_written() {
        let folder = tempfile::tempdir().unwrap();
        write_all(folder.path(), &[("x.txt", b"old".into())]).unwrap();
        let blocked = folder.path().join("x.txt/under-a-file");
        assert!(write_all(&blocked, &[("y.txt", b"new".into())]).is_err());
        std::fs::create_dir(folder.path().join("y.txt")).unwrap();
        let files = [("x.txt", b"new".to_vec()), ("y.txt", b"new".to_vec())];
        assert!(write_all(folder.path(), &files).is_err());
        assert_eq!(std::fs::read_to_string(folder.path().join("x.txt")).unwrap(), "old");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
    }
}
