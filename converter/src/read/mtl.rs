//! MTL: the materials of OBJ files.
//!
//! | statement | becomes |
//! |---|---|
//! | `Kd`, `map_Kd` | diffuse colour and texture, multiplied |
//! | `d`, `Tr` | opacity, `1 − Tr` |
//! | `map_d` | where the surface is: its alpha if it has any, or else its brightness |
//! | `Ks`, `Ns` | colour and exponent of highlights, unless `illum` is 0 or 1 |
//! | `illum` 3 to 9 | reflectivity, the mean of `Ks` |
//! | `illum` 4, 6, 7, 9 with `Tf` | opacity, at most 1 − the mean of `Tf` |
//! | `Ni` | index of refraction, if light passes through |
//! | `Ke` | emission |
//! | `map_Bump`, `bump` | heights, or directions if the image looks like a map of normals |
//! | `norm` | directions in tangent space |
//! | `disp`, `map_disp` | displacement |

mod texture_statement;

use super::named_file::{find_file, read_file};
use super::textures::Textures;
use super::without_byte_order_mark;
use crate::{Channel, DisplacementMap, Image, Material, NormalMap, NormalMapKind, TextureMap};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use texture_statement::TextureStatement;

/// Reads the library that an `mtllib` statement names, relative to the model's folder, and the textures it names.
///
/// What cannot be read becomes a warning, and materials that are missing. Textures are read for the materials in `used`.
pub(super) fn load_materials(
    folder: &Path,
    library: &str,
    used: &BTreeSet<&str>,
    textures: &mut Textures,
    warnings: &mut Vec<String>,
) -> Vec<Material> {
    let mut materials = Vec::new();
    for path in files(folder, library) {
        match read_file(&path) {
            Ok(bytes) => {
                let mut library =
                    Library { path: &path, line: 0, used, textures, warnings, materials: Vec::new() };
                library.read(&String::from_utf8_lossy(without_byte_order_mark(&bytes)));
                materials.extend(library.materials.into_iter().map(Draft::finish));
            }
            Err(error) => warnings.push(format!("{}: cannot read the materials: {error}", path.display())),
        }
    }
    materials
}

/// The files of an `mtllib` statement: one whose name may contain blanks, or several separated by them.
fn files(folder: &Path, library: &str) -> Vec<PathBuf> {
    let whole = find_file(folder, library);
    if whole.is_file() || !library.contains(char::is_whitespace) {
        return vec![whole];
    }
    library.split_whitespace().map(|name| find_file(folder, name)).collect()
}

/// Statements of textures whose names do not begin with `map_`.
const TEXTURES: [&str; 5] = ["bump", "disp", "norm", "refl", "decal"];

/// A material as it is being read: some statements mean something only together.
#[derive(Default)]
struct Draft {
    material: Material,
    has_diffuse: bool,
    illumination: Option<u32>,
    refraction_index: Option<f64>,
    transmission: Option<[f64; 3]>,
}

impl Draft {
    fn finish(self) -> Material {
        let mut material = self.material;
        let is_black = material.diffuse == [0.0; 3];
        // A texture times black is never meant; some programs write it.
        if material.diffuse_map.is_some() && (!self.has_diffuse || is_black) {
            material.diffuse = [1.0; 3];
        }
        match self.illumination {
            Some(0 | 1) => material.specular = [0.0; 3],
            Some(3..=9) => material.reflectivity = mean(material.specular).clamp(0.0, 1.0),
            _ => {}
        }
        if let (Some(4 | 6 | 7 | 9), Some(filter)) = (self.illumination, self.transmission) {
            material.opacity = material.opacity.min(1.0 - mean(filter).clamp(0.0, 1.0));
        }
        if let Some(index) = self.refraction_index.filter(|_| material.opacity < 1.0) {
            material.refraction_index = index;
        }
        material
    }
}

fn mean(color: [f64; 3]) -> f64 {
    color.iter().sum::<f64>() / 3.0
}

/// An MTL file as it is being read.
struct Library<'a> {
    path: &'a Path,
    /// Number of the line, from 1.
    line: usize,
    used: &'a BTreeSet<&'a str>,
    textures: &'a mut Textures,
    warnings: &'a mut Vec<String>,
    materials: Vec<Draft>,
}

impl Library<'_> {
    fn read(&mut self, text: &str) {
        for (index, line) in text.lines().enumerate() {
            self.line = index + 1;
            let line = line.trim();
            let (keyword, rest) = line.split_at(line.find(char::is_whitespace).unwrap_or(line.len()));
            let rest = rest.trim();
            let is_texture = keyword.get(..4).is_some_and(|start| start.eq_ignore_ascii_case("map_"))
                || TEXTURES.iter().any(|texture| texture.eq_ignore_ascii_case(keyword));
            if keyword == "newmtl" {
                if rest.is_empty() {
                    self.warn("`newmtl` without a name");
                }
                let material = Material { name: rest.to_owned(), ..Material::default() };
                self.materials.push(Draft { material, ..Draft::default() });
            } else if let Some(mut draft) = self.materials.pop() {
                // Libraries may hold the textures of many models.
                if !is_texture || self.used.contains(draft.material.name.as_str()) {
                    self.statement(&mut draft, keyword, rest);
                }
                self.materials.push(draft);
            }
        }
        self.materials.retain(|draft| !draft.material.name.is_empty());
    }

    fn warn(&mut self, problem: &str) {
        self.warnings.push(format!("{}:{}: {problem}", self.path.display(), self.line));
    }

    fn statement(&mut self, draft: &mut Draft, keyword: &str, rest: &str) {
        let material = &mut draft.material;
        // Programs do not agree on upper and lower case.
        match keyword.to_ascii_lowercase().as_str() {
            "kd" => {
                if let Some(color) = self.color(keyword, rest, "the material is grey") {
                    material.diffuse = color;
                    draft.has_diffuse = true;
                }
            }
            "ks" => set(&mut material.specular, self.color(keyword, rest, "it is left out")),
            "ke" => set(&mut material.emission, self.color(keyword, rest, "it is left out")),
            "tf" => draft.transmission = self.color(keyword, rest, "it is left out").or(draft.transmission),
            "ns" => set(&mut material.shininess, self.number(keyword, rest, 0.0..=f64::MAX)),
            "d" => {
                // A halo makes only the rim opaque.
                let rest = rest.strip_prefix("-halo").map_or(rest, str::trim);
                set(&mut material.opacity, self.number(keyword, rest, 0.0..=1.0));
            }
            "tr" => set(&mut material.opacity, self.number(keyword, rest, 0.0..=1.0).map(|tr| 1.0 - tr)),
            "ni" => {
                let index = self.number(keyword, rest, 0.001..=10.0);
                draft.refraction_index = index.or(draft.refraction_index);
            }
            "illum" => {
                let model = self.number(keyword, rest, 0.0..=10.0);
                draft.illumination = model.map(|model| model as u32).or(draft.illumination);
            }
            "map_kd" => {
                if let Some((map, _)) = self.texture(keyword, rest) {
                    material.diffuse_map = Some(map);
                }
            }
            "map_d" => {
                if let Some((mut map, statement)) = self.texture(keyword, rest) {
                    if !statement.chooses_channel {
                        let has_alpha = has_alpha(&self.textures.images[map.image]);
                        map.channel = if has_alpha { Channel::Alpha } else { Channel::Luminance };
                    }
                    material.opacity_map = Some(map);
                }
            }
            "map_bump" | "bump" => {
                if let Some((map, statement)) = self.texture(keyword, rest) {
                    let multiplier = statement.multiplier.unwrap_or(1.0);
                    let is_tangent =
                        !statement.chooses_channel && looks_like_normals(&self.textures.images[map.image]);
                    material.normal_map = Some(if is_tangent {
                        NormalMap { map, kind: NormalMapKind::Tangent { strength: multiplier } }
                    } else {
                        NormalMap { map: scalar(map), kind: NormalMapKind::Height { multiplier } }
                    });
                }
            }
            "norm" | "map_kn" => {
                if let Some((map, statement)) = self.texture(keyword, rest) {
                    let strength = statement.multiplier.unwrap_or(1.0);
                    material.normal_map = Some(NormalMap { map, kind: NormalMapKind::Tangent { strength } });
                }
            }
            "disp" | "map_disp" => {
                if let Some((map, statement)) = self.texture(keyword, rest) {
                    let multiplier = statement.multiplier.unwrap_or(1.0);
                    material.displacement_map = Some(DisplacementMap { map: scalar(map), multiplier });
                }
            }
            keyword if keyword.starts_with("map_") || matches!(keyword, "refl" | "decal") => {
                self.warn(&format!(
                    "`{keyword}` is left out; textures are read for diffuse colour, opacity, normals and displacement"
                ));
            }
            _ => {}
        }
    }

    /// A colour of one number for all three channels or of three; a warning if it is none.
    fn color(&mut self, keyword: &str, rest: &str, consequence: &str) -> Option<[f64; 3]> {
        let numbers: Option<Vec<f64>> = words(rest).map(number).collect();
        match numbers.as_deref() {
            Some(&[grey]) => Some([grey; 3]),
            Some(&[red, green, blue]) => Some([red, green, blue]),
            _ => {
                self.warn(&format!("`{keyword} {rest}` is no colour of red, green and blue: {consequence}"));
                None
            }
        }
    }

    /// A number, moved into a range; a warning if it is none.
    fn number(&mut self, keyword: &str, rest: &str, range: std::ops::RangeInclusive<f64>) -> Option<f64> {
        match words(rest).next().and_then(number) {
            Some(number) => Some(number.clamp(*range.start(), *range.end())),
            None => {
                self.warn(&format!("`{keyword} {rest}` has no number: it is left out"));
                None
            }
        }
    }

    /// A texture map with its image; a warning if there is none.
    fn texture<'t>(&mut self, keyword: &str, rest: &'t str) -> Option<(TextureMap, TextureStatement<'t>)> {
        let Some(mut statement) = TextureStatement::parse(rest) else {
            self.warn(&format!("`{keyword} {rest}` names no file: it is left out"));
            return None;
        };
        for option in std::mem::take(&mut statement.odd_options) {
            self.warn(&format!(
                "the option `{option}` of `{keyword}` is unknown or incomplete, and left out"
            ));
        }
        let folder = self.path.parent().unwrap_or(Path::new(""));
        let mut problems = Vec::new();
        let image = self.textures.load(folder, statement.file, &mut problems);
        problems.into_iter().for_each(|problem| self.warn(&problem));
        Some((TextureMap { image: image?, ..statement.map }, statement))
    }
}

fn set<T>(target: &mut T, value: Option<T>) {
    if let Some(value) = value {
        *target = value;
    }
}

/// Words before a comment.
fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split_whitespace().take_while(|word| !word.starts_with('#'))
}

fn number(word: &str) -> Option<f64> {
    word.parse().ok().filter(|number: &f64| number.is_finite())
}

/// The map, of brightness if no other channel was chosen.
fn scalar(map: TextureMap) -> TextureMap {
    let channel = if map.channel == Channel::Color { Channel::Luminance } else { map.channel };
    TextureMap { channel, ..map }
}

fn has_alpha(image: &Image) -> bool {
    image.pixels().iter().any(|pixel| pixel[3] != 255)
}

/// Whether an image shows directions in tangent space: then red and green are grey in the mean, and blue is bright.
/// Many programs write them as `map_Bump`, which the format means for heights.
fn looks_like_normals(image: &Image) -> bool {
    let mut sums = [0u64; 3];
    for pixel in image.pixels() {
        sums.iter_mut().zip(pixel).for_each(|(sum, &value)| *sum += u64::from(value));
    }
    let [red, green, blue] = sums.map(|sum| sum / image.pixels().len() as u64);
    red.abs_diff(128) < 20 && green.abs_diff(128) < 20 && blue > 190
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A folder with images: `grey.png` and `alpha.png` of brightness 100, the latter half transparent, and `normals.png`.
    fn folder() -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for (name, pixels) in [
            ("grey.png", [[100, 100, 100, 255]; 2]),
            ("alpha.png", [[100, 100, 100, 255], [100, 100, 100, 0]]),
            ("normals.png", [[120, 130, 250, 255], [130, 120, 255, 255]]),
        ] {
            let pixels = image::RgbaImage::from_raw(2, 1, pixels.as_flattened().to_vec()).unwrap();
            pixels.save(folder.path().join(name)).unwrap();
        }
        folder
    }

    fn load(text: &str) -> (Vec<Material>, Textures, Vec<String>) {
        let folder = folder();
        std::fs::write(folder.path().join("m.mtl"), text).unwrap();
        let (mut textures, mut warnings) = (Textures::default(), Vec::new());
        let used = BTreeSet::from(["a", "b", "c"]);
        let materials = load_materials(folder.path(), "m.mtl", &used, &mut textures, &mut warnings);
        let prefix = format!("{}/", folder.path().display());
        (materials, textures, warnings.iter().map(|warning| warning.replace(&prefix, "")).collect())
    }

    fn one(statements: &str) -> Material {
        let (materials, _, warnings) = load(&format!("newmtl a\n{statements}"));
        assert!(warnings.is_empty() && materials.len() == 1, "{warnings:?}");
        materials.into_iter().next().unwrap()
    }

    #[test]
    fn numbers_are_read() {
        let material =
            one("KD 1 0.5 0 # orange\r\nKs 0.3\nNs 60\nd 0.84\nNi 1.5\nKe 0 2 0\nillum 2\nPr 0.5\nKa 1 1 1");
        let expected = Material {
            specular: [0.3; 3],
            shininess: 60.0,
            opacity: 0.84,
            refraction_index: 1.5,
            emission: [0.0, 2.0, 0.0],
            ..Material::matte("a", [1.0, 0.5, 0.0])
        };
        assert_eq!(material, expected);
        assert_eq!(one("Tr 0.25").opacity, 0.75);
        assert_eq!(one("d -halo 0.5").opacity, 0.5);
        // Out of range: as near as possible. Opaque: what light does within does not matter.
        let odd = one("d 7\nNs -3\nNi 1.5");
        assert_eq!(odd, Material::matte("a", Material::DEFAULT_DIFFUSE));
    }

    #[test]
    fn the_illumination_model_tells_what_is_mirrored() {
        let reflectivity = |model| one(&format!("Ks 0.2 0.4 0.6\nillum {model}")).reflectivity;
        assert!([0, 1, 2, 10].iter().all(|model| reflectivity(*model) == 0.0));
        assert!((3..=9).all(|model| (reflectivity(model) - 0.4).abs() < 1e-12));
        assert_eq!(one("Ks 1\nillum 1").specular, [0.0; 3]);
        // A filter of white is written for opaque materials too.
        assert_eq!(one("Tf 1 1 1\nillum 2").opacity, 1.0);
        let glass = one("Ni 1.3\nTf 0.5 0.75 1\nillum 7");
        assert_eq!((glass.opacity, glass.refraction_index), (0.25, 1.3));
    }

    #[test]
    fn textures_are_read_with_their_options() {
        let (materials, textures, warnings) = load(
            "newmtl a\nmap_Kd -s 2 3 GREY.png\nmap_d alpha.png\nbump -bm 0.5 grey.png\ndisp -bm 2 -imfchan g grey.png\n\
             newmtl b\nKd 0 0 0\nmap_Kd .\\grey.png\nmap_d grey.png\nmap_Bump normals.png\n\
             newmtl c\nKd 0.5 0.5 0.5\nmap_Kd grey.png\nnorm -bm 2 normals.png\nmap_d -imfchan r -mm 0.5 0.5 alpha.png\n",
        );
        assert!(warnings.is_empty(), "{warnings:?}");
        assert_eq!(textures.images.len(), 3);
        let [a, b, c] = &materials[..] else { panic!("{}", materials.len()) };
        // Without a colour, and with black, the texture shows as it is.
        assert_eq!([a.diffuse, b.diffuse, c.diffuse], [[1.0; 3], [1.0; 3], [0.5; 3]]);
        assert_eq!(a.diffuse_map.unwrap().scale, [2.0, 3.0]);
        assert_eq!(a.diffuse_map.unwrap().image, b.diffuse_map.unwrap().image);
        let channels = [a, b, c].map(|material| material.opacity_map.unwrap().channel);
        assert_eq!(channels, [Channel::Alpha, Channel::Luminance, Channel::Red]);
        assert_eq!((c.opacity_map.unwrap().base, c.opacity_map.unwrap().gain), (0.5, 0.5));
        let kinds = [a, b, c].map(|material| material.normal_map.unwrap().kind);
        assert_eq!(
            kinds,
            [
                NormalMapKind::Height { multiplier: 0.5 },
                NormalMapKind::Tangent { strength: 1.0 },
                NormalMapKind::Tangent { strength: 2.0 }
            ]
        );
        let displacement = a.displacement_map.unwrap();
        assert_eq!((displacement.multiplier, displacement.map.channel), (2.0, Channel::Green));
    }

    #[test]
    fn what_is_left_out_is_a_warning() {
        let (materials, textures, warnings) = load(
            "Kd 1 1 1\nnewmtl a\nKd 0.5 0.5 0.5\nmap_Kd lost.png\nmap_Ks grey.png\nmap_d -fancy 3 grey.png\nNs high\n\
             map_Bump\nnewmtl\nKd 1 1 1\nnewmtl unused\nmap_Kd unused.png\n",
        );
        assert_eq!(materials.len(), 2);
        assert_eq!(materials[0].diffuse, [0.5; 3]);
        assert_eq!(materials[0].diffuse_map, None);
        assert!(textures.images.is_empty());
        for expected in [
            "m.mtl:4: lost.png: cannot read the texture",
            "m.mtl:5: `map_ks` is left out",
            "m.mtl:6: the option `-fancy` of `map_d`",
            "m.mtl:6: 3 grey.png: cannot read",
            "m.mtl:7: `Ns high` has no number",
            "m.mtl:8: `map_Bump ` names no file",
            "m.mtl:9: `newmtl` without a name",
        ] {
            assert!(warnings.iter().any(|warning| warning.starts_with(expected)), "{expected}: {warnings:?}");
        }
        assert_eq!(warnings.len(), 7, "{warnings:?}");
    }
}
