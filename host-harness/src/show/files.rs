//! Files that appear whole or not at all.

use std::io::Write;
use std::path::Path;

use anyhow::Context;
use tempfile::NamedTempFile;

/// Writes every file into `folder`: first all of them beside their places, then into place.
pub fn write_all(folder: &Path, files: &[(&str, Vec<u8>)]) -> anyhow::Result<()> {
    let context = || format!("writing into {}", folder.display());
    std::fs::create_dir_all(folder).with_context(context)?;
    // What would stop a later file must not leave an earlier one replaced.
    for path in files.iter().map(|(name, _)| folder.join(name)) {
        anyhow::ensure!(!path.is_dir(), "writing {}: it is a directory", path.display());
    }
    let mut ready = Vec::new();
    for (name, content) in files {
        let mut file = NamedTempFile::new_in(folder).with_context(context)?;
        file.write_all(content).with_context(context)?;
        readable_by_all(&file)?;
        ready.push((file, folder.join(name)));
    }
    for (file, path) in ready {
        let persisted = file.persist(&path).map_err(|e| e.error);
        persisted.with_context(|| format!("writing {}", path.display()))?;
    }
    Ok(())
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
