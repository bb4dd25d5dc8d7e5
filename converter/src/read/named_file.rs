//! Files that a model names: libraries of materials, textures, buffers.

use std::io::{Error, ErrorKind, Result};
use std::path::{Path, PathBuf};

/// Where the file is that another file in `folder` calls `name`.
///
/// Names come from other systems: separators may be backslashes, letters may have another case, and an absolute path may
/// be one of another machine, whose file lies beside the model here. If nothing is found it is the name as it stands.
pub(super) fn find_file(folder: &Path, name: &str) -> PathBuf {
    let name = name.replace('\\', "/");
    let written = folder.join(&name);
    if written.is_file() {
        return written;
    }
    let parts: Vec<&str> = name.split('/').filter(|part| !matches!(*part, "" | ".")).collect();
    // The whole path first, then its last parts alone.
    (0..parts.len()).find_map(|skipped| find_in_any_case(folder, &parts[skipped..])).unwrap_or(written)
}

/// The file at the end of a path whose letters may have another case.
fn find_in_any_case(folder: &Path, parts: &[&str]) -> Option<PathBuf> {
    let mut path = folder.to_owned();
    for part in parts {
        let exact = path.join(part);
        path = if exact.exists() { exact } else { entry_in_any_case(&path, part)? };
    }
    path.is_file().then_some(path)
}

fn entry_in_any_case(folder: &Path, name: &str) -> Option<PathBuf> {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let is_alike = |entry: &PathBuf| {
        entry.file_name().is_some_and(|found| found.to_string_lossy().to_lowercase() == name.to_lowercase())
    };
    // The first in the order of names: folders have no order of their own.
    std::fs::read_dir(folder).ok()?.filter_map(|entry| Some(entry.ok()?.path())).filter(is_alike).min()
}

/// The bytes of a file that a model names; an error if it is none, such as a device that never ends.
pub(super) fn read_file(path: &Path) -> Result<Vec<u8>> {
    if path.metadata()?.is_file() {
        return std::fs::read(path);
    }
    Err(Error::new(ErrorKind::InvalidInput, "it is no file"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_found_as_other_systems_name_them() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        std::fs::create_dir(folder.join("Textures")).unwrap();
        let file = folder.join("Textures").join("Old Bark.png");
        std::fs::write(&file, "").unwrap();
        for name in [
            "Textures/Old Bark.png",
            "Textures\\Old Bark.png",
            "./textures/old bark.PNG",
            "C:\\models\\tree\\textures\\Old Bark.png",
        ] {
            assert_eq!(find_file(folder, name), file, "{name}");
        }
        let missing = find_file(folder, "textures\\moss.png");
        assert_eq!(missing, folder.join("textures/moss.png"));
        // A folder is no file.
        assert!(!find_file(folder, "textures").is_file());
    }

    #[test]
    fn what_is_no_file_is_not_read() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(read_file(folder.path()).unwrap_err().kind(), ErrorKind::InvalidInput);
        assert_eq!(read_file(&folder.path().join("missing")).unwrap_err().kind(), ErrorKind::NotFound);
    }
}
