//! The files of textures.

use super::named_file::{find_file, read_file};
use crate::Image;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// Images that materials refer to, each read once.
#[derive(Debug, Default)]
pub(super) struct Textures {
    pub images: Vec<Image>,
    /// Index of the image, `None` if it could not be read.
    by_path: HashMap<PathBuf, Option<usize>>,
}

impl Textures {
    /// Index of the image that a file in `folder` calls `name`. What cannot be read becomes a warning, once.
    pub(super) fn load(&mut self, folder: &Path, name: &str, warnings: &mut Vec<String>) -> Option<usize> {
        let path = find_file(folder, name);
        if let Some(&known) = self.by_path.get(&path) {
            return known;
        }
        let shown = path.display().to_string();
        let image = match read_file(&path) {
            Ok(bytes) => Image::decode(&*shown, &bytes).map_err(|error| error.to_string()),
            Err(error) => Err(format!("{shown}: cannot read the texture: {error}")),
        };
        let index = match image {
            Ok(image) => {
                self.images.push(image);
                Some(self.images.len() - 1)
            }
            Err(problem) => {
                warnings.push(format!("{problem}; the material's colour stands for it"));
                None
            }
        };
        self.by_path.insert(path, index);
        index
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_image_is_read_once_and_reported_once() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("broken.png"), "no picture").unwrap();
        let (mut textures, mut warnings) = (Textures::default(), Vec::new());
        for name in ["broken.png", "missing.png", "BROKEN.png", "missing.png"] {
            assert_eq!(textures.load(folder.path(), name, &mut warnings), None);
        }
        assert_eq!(warnings.len(), 2, "{warnings:?}");
        assert!(warnings[0].contains("broken.png") && warnings[1].contains("missing.png: cannot read"));
    }
}
