//! Colours of materials from MTL files.

use std::io::Cursor;
use std::path::{Path, PathBuf};

/// Reads the library that an `mtllib` statement names, relative to the model's folder.
///
/// What cannot be read becomes a warning, and materials that are missing.
pub(crate) fn load_materials(
    folder: &Path,
    library: &Path,
    warnings: &mut Vec<String>,
) -> tobj::MTLLoadResult {
    let mut text = String::new();
    for path in files(folder, library) {
        match std::fs::read(&path) {
            Ok(bytes) => prepare(&path, &String::from_utf8_lossy(&bytes), &mut text, warnings),
            Err(error) => warnings.push(format!("{}: cannot read the materials: {error}", path.display())),
        }
    }
    tobj::load_mtl_buf(&mut Cursor::new(text))
}

/// The files of an `mtllib` statement: one whose name may contain blanks, or several separated by them.
fn files(folder: &Path, library: &Path) -> Vec<PathBuf> {
    let whole = folder.join(library);
    let names = library.to_string_lossy();
    if whole.exists() || !names.contains(char::is_whitespace) {
        return vec![whole];
    }
    names.split_whitespace().map(|name| folder.join(name)).collect()
}

/// Appends the statements that matter here, in a form at which the parser does not fail: it expects three numbers after
/// `Kd`, where the format also allows one, and spectra.
fn prepare(path: &Path, text: &str, prepared: &mut String, warnings: &mut Vec<String>) {
    for (index, line) in text.lines().enumerate() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("newmtl") => {
                let name = line.trim()["newmtl".len()..].trim();
                if !name.is_empty() {
                    prepared.push_str(&format!("newmtl {name}\n"));
                }
            }
            Some("Kd") => match diffuse(words) {
                Some([red, green, blue]) => prepared.push_str(&format!("Kd {red} {green} {blue}\n")),
                None => warnings.push(format!(
                    "{}:{}: `{}` is no colour of red, green and blue: the material is grey",
                    path.display(),
                    index + 1,
                    line.trim()
                )),
            },
            _ => {}
        }
    }
}

/// The colour of a `Kd` statement; one number stands for all three channels.
fn diffuse<'a>(words: impl Iterator<Item = &'a str>) -> Option<[f64; 3]> {
    let numbers: Vec<f64> = words
        .take_while(|word| !word.starts_with('#'))
        .map(|word| word.parse().ok().filter(|number: &f64| number.is_finite()))
        .collect::<Option<_>>()?;
    match numbers[..] {
        [grey] => Some([grey; 3]),
        [red, green, blue] => Some([red, green, blue]),
        _ => None,
    }
}
