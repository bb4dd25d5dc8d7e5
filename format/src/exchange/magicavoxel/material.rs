//! Materials, as far as both formats know the same.
//!
//! | MagicaVoxel | here |
//! |---|---|
//! | `_metal` | reflectivity; roughness gives the exponent of the highlight |
//! | `_glass` | transparency, index of refraction |
//! | `_emit` | emission: the colour, times `_emit`, times 1 + `_flux` |
//! | others | a matte colour |

use super::chunks::Dictionary;
use crate::Material;

/// The material of a colour, with what the file says of it.
pub(super) fn import(color: [u8; 3], attributes: Option<&Dictionary>) -> Material {
    let matte = Material::matte(color);
    let Some(attributes) = attributes else { return matte };
    let number = |name: &str| {
        let value = attributes.get(name)?.trim().parse::<f32>().ok()?;
        value.is_finite().then_some(value)
    };
    // Older files say how much with a weight, whatever it is.
    let share = |name: &str| number(name).or_else(|| number("_weight")).unwrap_or(0.0).clamp(0.0, 1.0);
    let in_255 = |share: f32| (share * 255.0).round() as u8;
    match attributes.get("_type").map(String::as_str) {
        Some("_metal") => Material {
            reflectivity: in_255(share("_metal")),
            specular: color,
            shininess: shininess(number("_rough").unwrap_or(0.1)),
            ..matte
        },
        Some("_glass") => Material {
            transparency: in_255(
                number("_alpha").map_or_else(|| share("_trans"), |alpha| 1.0 - alpha.clamp(0.0, 1.0)),
            ),
            // "_ior" is what the index is more than 1.
            refraction_index: number("_ri")
                .or_else(|| Some(1.0 + number("_ior")?))
                .unwrap_or(1.3)
                .clamp(1.0, 4.0),
            ..matte
        },
        Some("_emit") => {
            let strength = share("_emit") * (1.0 + number("_flux").unwrap_or(0.0).clamp(0.0, 100.0));
            Material { emission: color.map(|channel| linear(channel) * strength), ..matte }
        }
        _ => matte,
    }
}

/// What makes a material other than matte, for the dictionary of a file.
pub(super) fn export(material: &Material) -> Option<Vec<(&'static str, String)>> {
    let of_255 = |share: u8| (f32::from(share) / 255.0).to_string();
    let brightest = material.emission.iter().copied().fold(0.0, f32::max);
    let entries = if brightest > 0.0 {
        let color = material.diffuse.map(linear).into_iter().fold(0.0, f32::max);
        let strength = if color > 0.0 { brightest / color } else { 1.0 };
        let flux = (strength - 1.0).max(0.0);
        vec![("_type", "_emit".into()), ("_emit", strength.min(1.0).to_string()), ("_flux", flux.to_string())]
    } else if material.transparency > 0 {
        let beyond_one = (material.refraction_index - 1.0).max(0.0);
        vec![
            ("_type", "_glass".into()),
            ("_trans", of_255(material.transparency)),
            ("_ior", beyond_one.to_string()),
            ("_ri", (1.0 + beyond_one).to_string()),
        ]
    } else if material.reflectivity > 0 {
        let rough = roughness(material.shininess).to_string();
        vec![("_type", "_metal".into()), ("_metal", of_255(material.reflectivity)), ("_rough", rough)]
    } else {
        return None;
    };
    Some(entries)
}

/// Light of an sRGB value (IEC 61966-2-1).
fn linear(channel: u8) -> f32 {
    let value = f32::from(channel) / 255.0;
    if value <= 0.040_45 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

/// Phong's exponent of a roughness: 2/α² − 2 with α = roughness² (Walter et al. 2007).
fn shininess(roughness: f32) -> f32 {
    (2.0 / roughness.abs().max(0.05).powi(4) - 2.0).clamp(0.0, 10_000.0)
}

fn roughness(shininess: f32) -> f32 {
    (2.0 / (shininess + 2.0)).powf(0.25)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dictionary(entries: &[(&str, &str)]) -> Dictionary {
        entries.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect()
    }

    #[test]
    fn glass_light_and_metal_are_known() {
        let glass = dictionary(&[("_type", "_glass"), ("_trans", "0.8"), ("_ior", "0.5")]);
        let expected = Material { transparency: 204, refraction_index: 1.5, ..Material::matte([9, 8, 7]) };
        assert_eq!(import([9, 8, 7], Some(&glass)), expected);
        let light = dictionary(&[("_type", "_emit"), ("_emit", "0.5"), ("_flux", "3")]);
        assert_eq!(import([255, 0, 0], Some(&light)).emission, [2.0, 0.0, 0.0]);
        let metal = dictionary(&[("_type", "_metal"), ("_weight", "1"), ("_rough", "1")]);
        let metal = import([1, 2, 3], Some(&metal));
        assert_eq!((metal.reflectivity, metal.shininess), (255, 0.0));
    }

    #[test]
    fn what_is_not_known_is_matte() {
        let strange = [("_type", "_media"), ("_trans", "1")];
        assert_eq!(import([1, 2, 3], Some(&dictionary(&strange))), Material::matte([1, 2, 3]));
        let senseless = [("_type", "_glass"), ("_trans", "NaN"), ("_ior", "-inf")];
        let material = import([1, 2, 3], Some(&dictionary(&senseless)));
        assert_eq!((material.transparency, material.refraction_index), (0, 1.3));
        assert_eq!(import([1, 2, 3], None), Material::matte([1, 2, 3]));
    }

    #[test]
    fn what_is_exported_can_be_imported() {
        let matte = Material::matte([255, 128, 64]);
        let materials = [
            Material { transparency: 77, refraction_index: 1.25, ..matte },
            Material { reflectivity: 51, specular: matte.diffuse, shininess: 30.0, ..matte },
            Material { emission: matte.diffuse.map(|channel| 3.0 * linear(channel)), ..matte },
        ];
        for material in materials {
            let entries = export(&material).unwrap();
            let attributes = entries.into_iter().map(|(key, value)| (key.to_owned(), value)).collect();
            let found = import(material.diffuse, Some(&attributes));
            let near = |a: f32, b: f32| (a - b).abs() <= 1e-4 * (1.0 + b.abs());
            assert_eq!(
                (found.transparency, found.reflectivity),
                (material.transparency, material.reflectivity)
            );
            assert!(near(found.refraction_index, material.refraction_index));
            assert!(near(found.shininess, material.shininess));
            assert!((0..3).all(|k| near(found.emission[k], material.emission[k])));
        }
        assert_eq!(export(&matte), None);
    }
}
