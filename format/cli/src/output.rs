//! Files that appear whole or not at all.

use anyhow::Context;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use tempfile::NamedTempFile;

/// Temporary files that exist at this moment, so that an interrupt can remove them.
static TEMPORARY_FILES: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Exit status of a program ended by an interrupt, as shells expect it (128 + SIGINT).
const INTERRUPTED: i32 = 130;

/// Writes `path` through a temporary file in the same folder, renamed when `write` has succeeded.
///
/// On an error, and on Ctrl-C if the program was started by [`crate::run`], the temporary file is removed
/// and an older `path` stays as it was.
///
/// # Errors
/// What `write` returns, or the failure to create, write, flush or rename the file, with the path named.
pub fn write_atomically<T>(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&File>) -> anyhow::Result<T>,
) -> anyhow::Result<T> {
    write_file_atomically(path, |file| {
        let mut buffered = BufWriter::with_capacity(1 << 18, file);
        let value = write(&mut buffered)?;
        buffered.flush()?;
        Ok(value)
    })
}

/// As [`write_atomically`], handing out the bare file: for writers that seek or write at offsets.
///
/// # Errors
/// As [`write_atomically`].
pub fn write_file_atomically<T>(
    path: &Path,
    write: impl FnOnce(&File) -> anyhow::Result<T>,
) -> anyhow::Result<T> {
    let cannot = || format!("{}: cannot write", path.display());
    if path.is_dir() {
        anyhow::bail!("{}: is a folder, name a file in it", path.display());
    }
    // A device such as /dev/null must not be replaced by a file of that name.
    if path.exists() && !path.is_file() {
        let file = File::create(path).with_context(cannot)?;
        return write(&file).with_context(cannot);
    }
    // Through a symbolic link the file that it leads to is replaced, not the link.
    let target = std::fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
    let folder = match target.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let (temporary, _registered) = create_temporary(folder).with_context(cannot)?;
    if let Ok(older) = std::fs::metadata(&target) {
        temporary.as_file().set_permissions(older.permissions()).with_context(cannot)?;
    }
    let value = write(temporary.as_file()).map_err(|error| {
        // What is wrong with what should be written is not a matter of the file.
        let is_of_the_system = error.chain().any(|cause| cause.is::<std::io::Error>());
        if is_of_the_system { error.context(cannot()) } else { error }
    })?;
    temporary.persist(&target).map_err(|failure| failure.error).with_context(cannot)?;
    Ok(value)
}

/// A temporary file that an interrupt removes, with the permissions of an ordinary new file.
fn create_temporary(folder: &Path) -> std::io::Result<(NamedTempFile, Registered)> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".octvox-").suffix(".part");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // As for every file that a program creates, the user's mask takes its share off.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    // Under the lock, so that an interrupt finds no file that is not registered yet.
    let mut files = temporary_files();
    let temporary = builder.tempfile_in(folder)?;
    files.push(temporary.path().to_path_buf());
    let registered = Registered(temporary.path().to_path_buf());
    Ok((temporary, registered))
}

/// Keeps a path in [`TEMPORARY_FILES`] while it lives.
struct Registered(PathBuf);

impl Drop for Registered {
    fn drop(&mut self) {
        temporary_files().retain(|path| path != &self.0);
    }
}

/// The list is whole even if a thread has panicked with it.
fn temporary_files() -> MutexGuard<'static, Vec<PathBuf>> {
    TEMPORARY_FILES.lock().unwrap_or_else(PoisonError::into_inner)
}

pub(crate) fn remove_temporary_files_on_interrupt() {
    // Fails only if a handler is already set; then Ctrl-C is somebody else's business.
    let _ = ctrlc::set_handler(|| {
        // Held to the end of the process, so that no other thread creates a file in the meantime.
        let files = temporary_files();
        for path in files.iter() {
            let _ = std::fs::remove_file(path);
        }
        std::process::exit(INTERRUPTED);
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("model.vox");
        std::fs::write(&path, "old").unwrap();
        let failed: anyhow::Result<()> = write_atomically(&path, |out| {
            out.write_all(b"half")?;
            Err(std::io::Error::other("the disk is full").into())
        });
        let line = format!("{:#}", failed.unwrap_err());
        assert_eq!(line, format!("{}: cannot write: the disk is full", path.display()));
        let failed =
            write_atomically(&path, |_| anyhow::Result::<()>::Err(anyhow::anyhow!("too little memory")));
        assert_eq!(format!("{:#}", failed.unwrap_err()), "too little memory");
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_finished_write_replaces_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("model.vox");
        std::fs::write(&path, "old").unwrap();
        write_atomically(&path, |out| Ok(out.write_all(b"new")?)).unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "new");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_folder_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let error = write_atomically(folder.path(), |_| Ok(())).unwrap_err();
        assert!(error.to_string().contains("is a folder"));
    }

    #[test]
    #[cfg(unix)]
    fn permissions_are_those_of_an_ordinary_file() {
        use std::os::unix::fs::PermissionsExt;
        let mode = |path: &Path| std::fs::metadata(path).unwrap().permissions().mode() & 0o777;
        let folder = tempfile::tempdir().unwrap();
        let ordinary = folder.path().join("ordinary");
        std::fs::write(&ordinary, "").unwrap();
        let path = folder.path().join("model.vox");
        write_atomically(&path, |_| Ok(())).unwrap();
        assert_eq!(mode(&path), mode(&ordinary));

        std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o640)).unwrap();
        write_atomically(&path, |_| Ok(())).unwrap();
        assert_eq!(mode(&path), 0o640);
    }

    #[test]
    #[cfg(unix)]
    fn a_symbolic_link_stays_one() {
        let folder = tempfile::tempdir().unwrap();
        let (link, path) = (folder.path().join("link.vox"), folder.path().join("model.vox"));
        std::fs::write(&path, "old").unwrap();
        std::os::unix::fs::symlink(&path, &link).unwrap();
        write_atomically(&link, |out| Ok(out.write_all(b"new")?)).unwrap();
        assert!(link.is_symlink());
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "new");
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn a_device_is_written_to_and_not_replaced() {
        use std::os::unix::fs::FileTypeExt;
        let device = Path::new("/dev/null");
        write_atomically(device, |out| Ok(out.write_all(b"gone")?)).unwrap();
        assert!(std::fs::metadata(device).unwrap().file_type().is_char_device());
    }
}
