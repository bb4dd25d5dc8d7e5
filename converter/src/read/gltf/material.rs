//! Materials of glTF.
//!
//! | glTF | becomes |
//! |---|---|
//! | `baseColorFactor`, `baseColorTexture` | diffuse colour and texture, multiplied |
//! | `metallicFactor`, with the mean of its texture | colour of highlights: 4 % grey for what is no metal, the base colour for metal |
//! | `roughnessFactor`, with the mean of its texture | exponent of highlights, 2 / r⁴ − 2 (Walter et al. 2007) |
//! | both | reflectivity: the mean of the colour of highlights, as light, times (1 − r)² |
//! | `alphaMode` `MASK` | where the surface is, cut off at `alphaCutoff` |
//! | `alphaMode` `BLEND` | opacity: the factor times the mean alpha of what is not wholly transparent, which is cut out |
//! | `normalTexture` | directions in tangent space |
//! | `emissiveFactor`, with the mean of its texture and `KHR_materials_emissive_strength` | emission |
//! | `KHR_materials_transmission`, `KHR_materials_ior` | opacity, 1 − transmission, and the index of refraction |
//! | `KHR_materials_volume` | absorption, from the colour that is left after the attenuation distance |
//! | `KHR_materials_unlit` | no highlights |
//! | `KHR_texture_transform` | scale and offset of the texture; a rotation is left out, with a warning |

use super::resource::Resources;
use crate::color_space::{to_displayed, to_linear};
use crate::{Channel, Image, Material, NormalMap, NormalMapKind, TextureMap, Wrap};
use ::gltf::Document;
use ::gltf::material::AlphaMode;
use ::gltf::texture::{Info, Texture, WrappingMode};
use std::collections::HashMap;

/// Share of the light that what is no metal mirrors seen from the front.
const DIELECTRIC: f64 = 0.04;

/// A displayed colour (sRGB) for linear light, both from 0 to 1.
pub(super) fn displayed(light: [f64; 3]) -> [f64; 3] {
    to_displayed(light.map(|channel| (channel * 65_535.0).round() as u16))
        .map(|channel| f64::from(channel) / 255.0)
}

/// Materials as primitives ask for them.
pub(super) struct Materials<'a> {
    document: &'a Document,
    resources: &'a Resources,
    materials: Vec<Material>,
    /// The set of texture coordinates that each material uses.
    sets: Vec<u32>,
    /// Index of each material by its index in the file, `None` for the default one.
    by_index: HashMap<Option<usize>, u32>,
    images: Vec<Image>,
    /// Index of each image by its index in the file; `None` if it cannot be read.
    images_by_index: HashMap<usize, Option<usize>>,
    warnings: Vec<String>,
}

impl<'a> Materials<'a> {
    pub(super) fn new(document: &'a Document, resources: &'a Resources) -> Self {
        Self {
            document,
            resources,
            materials: Vec::new(),
            sets: Vec::new(),
            by_index: HashMap::new(),
            images: Vec::new(),
            images_by_index: HashMap::new(),
            warnings: Vec::new(),
        }
    }

    /// The materials that were asked for, their images, and warnings.
    pub(super) fn finish(self) -> (Vec<Material>, Vec<Image>, Vec<String>) {
        (self.materials, self.images, self.warnings)
    }

    /// The set of texture coordinates that a material uses.
    pub(super) fn texture_set(&self, material: u32) -> u32 {
        self.sets[material as usize]
    }

    /// Index of a material.
    pub(super) fn index(&mut self, source: &::gltf::Material<'a>) -> u32 {
        if let Some(&index) = self.by_index.get(&source.index()) {
            return index;
        }
        let (material, set) = self.convert(source);
        let index = self.materials.len() as u32;
        self.materials.push(material);
        self.sets.push(set);
        self.by_index.insert(source.index(), index);
        index
    }

    fn convert(&mut self, source: &::gltf::Material<'a>) -> (Material, u32) {
        let name = match (source.name(), source.index()) {
            (Some(name), _) => name.to_owned(),
            (None, Some(index)) => format!("material {index}"),
            (None, None) => "default material".to_owned(),
        };
        let pbr = source.pbr_metallic_roughness();
        let base = pbr.base_color_factor().map(|factor| f64::from(factor).clamp(0.0, 1.0));
        let color = [base[0], base[1], base[2]];
        let mut material = Material::matte(name, displayed(color));

        let base_texture = pbr.base_color_texture();
        let set =
            base_texture.as_ref().map(set_of).or(source.normal_texture().map(|normal| normal.tex_coord()));
        let set = set.unwrap_or(0);
        material.diffuse_map = base_texture.as_ref().and_then(|info| self.map_of(&material.name, info));
        self.set_opacity(&mut material, source, base[3]);
        self.set_highlight(&mut material, source, color);
        self.set_emission(&mut material, source);
        if let Some(normal) = source.normal_texture() {
            if normal.tex_coord() != set {
                self.warn(&material.name, "the normal map uses other texture coordinates than the colours");
            }
            let transform = normal.extension_value("KHR_texture_transform");
            let number = |name: &str, axis: usize, otherwise: f64| {
                transform.and_then(|transform| transform.get(name)?.get(axis)?.as_f64()).unwrap_or(otherwise)
                    as f32
            };
            let offset = [number("offset", 0, 0.0), number("offset", 1, 0.0)];
            let scale = [number("scale", 0, 1.0), number("scale", 1, 1.0)];
            let strength = f64::from(normal.scale());
            material.normal_map = self
                .map(&material.name, &normal.texture(), offset, scale)
                .map(|map| NormalMap { map, kind: NormalMapKind::Tangent { strength } });
        }
        (material, set)
    }

    fn set_opacity(&mut self, material: &mut Material, source: &::gltf::Material<'a>, alpha: f64) {
        let map = material.diffuse_map.map(|map| TextureMap { channel: Channel::Alpha, ..map });
        match source.alpha_mode() {
            AlphaMode::Opaque => {}
            AlphaMode::Mask => {
                material.alpha_cutoff = f64::from(source.alpha_cutoff().unwrap_or(0.5));
                material.opacity_map = map.map(|map| TextureMap { gain: alpha as f32, ..map });
                if map.is_none() && alpha < material.alpha_cutoff {
                    // Nothing of it is to be seen; voxels know no surface that is not there.
                    material.opacity = 0.0;
                }
            }
            AlphaMode::Blend => {
                let mean = map.map_or(1.0, |map| mean_alpha(&self.images[map.image]));
                // Only the rim of a cut-out: that is opaque.
                let mean = if mean > 0.9 { 1.0 } else { mean };
                material.opacity = alpha * mean;
                material.alpha_cutoff = 0.5 * mean;
                material.opacity_map = map;
            }
        }
        if let Some(transmission) = source.transmission() {
            material.opacity *= 1.0 - f64::from(transmission.transmission_factor()).clamp(0.0, 1.0);
            let index = f64::from(source.ior().unwrap_or(1.5));
            // Zero means that everything is mirrored, which no index of refraction does.
            material.refraction_index = if index >= 1.0 { index } else { 1.0 };
            if let Some(volume) = source.volume() {
                let distance = f64::from(volume.attenuation_distance());
                if distance > 0.0 && distance.is_finite() {
                    // After the distance the colour is left: exp(−a · distance).
                    material.absorption = volume
                        .attenuation_color()
                        .map(|left| -f64::from(left).clamp(1e-6, 1.0).ln() / distance + 0.0);
                }
            }
        }
    }

    fn set_highlight(&mut self, material: &mut Material, source: &::gltf::Material<'a>, color: [f64; 3]) {
        if source.unlit() {
            return;
        }
        let pbr = source.pbr_metallic_roughness();
        let [_, roughness, metal] =
            pbr.metallic_roughness_texture().map_or([1.0; 3], |info| self.mean_color(&material.name, &info));
        let metal = (metal * f64::from(pbr.metallic_factor())).clamp(0.0, 1.0);
        let roughness = (roughness * f64::from(pbr.roughness_factor())).clamp(0.0, 1.0);
        let mirrored = color.map(|channel| DIELECTRIC + (channel - DIELECTRIC) * metal);
        let smoothness = (1.0 - roughness) * (1.0 - roughness);
        material.reflectivity = mirrored.iter().sum::<f64>() / 3.0 * smoothness;
        let exponent = 2.0 / roughness.powi(4) - 2.0;
        if exponent >= 1.0 {
            material.specular = displayed(mirrored);
            material.shininess = exponent.min(10_000.0);
        }
    }

    fn set_emission(&mut self, material: &mut Material, source: &::gltf::Material<'a>) {
        let factor = source.emissive_factor().map(f64::from);
        if factor == [0.0; 3] {
            return;
        }
        let strength = f64::from(source.emissive_strength().unwrap_or(1.0));
        let texture = match source.emissive_texture() {
            Some(info) => self.mean_light(&material.name, &info),
            None => [1.0; 3],
        };
        material.emission = [0, 1, 2].map(|channel| (factor[channel] * strength * texture[channel]).max(0.0));
    }

    /// The mean of the colours of a texture as they stand, from 0 to 1; 1 if it cannot be read.
    fn mean_color(&mut self, material: &str, info: &Info<'a>) -> [f64; 3] {
        let Some(image) = self.image(material, &info.texture()) else { return [1.0; 3] };
        mean(&self.images[image], |[red, green, blue, _]| [red, green, blue].map(|v| f64::from(v) / 255.0))
    }

    /// The mean of the colours of a texture as light, from 0 to 1; 1 if it cannot be read.
    fn mean_light(&mut self, material: &str, info: &Info<'a>) -> [f64; 3] {
        let Some(image) = self.image(material, &info.texture()) else { return [1.0; 3] };
        let light =
            |[red, green, blue, _]: [u8; 4]| to_linear([red, green, blue]).map(|v| f64::from(v) / 65_535.0);
        mean(&self.images[image], light)
    }

    fn map_of(&mut self, material: &str, info: &Info<'a>) -> Option<TextureMap> {
        let (offset, scale) = match info.texture_transform() {
            Some(transform) => {
                if transform.rotation() != 0.0 {
                    self.warn(material, "the rotation of a texture is left out");
                }
                (transform.offset(), transform.scale())
            }
            None => ([0.0; 2], [1.0; 2]),
        };
        self.map(material, &info.texture(), offset, scale)
    }

    /// A texture with an offset and a scale of coordinates that go down.
    fn map(
        &mut self,
        material: &str,
        texture: &Texture<'a>,
        offset: [f32; 2],
        scale: [f32; 2],
    ) -> Option<TextureMap> {
        let image = self.image(material, texture)?;
        let sampler = texture.sampler();
        let wrap = [sampler.wrap_s(), sampler.wrap_t()].map(|mode| match mode {
            WrappingMode::Repeat => Wrap::Repeat,
            WrappingMode::ClampToEdge => Wrap::Clamp,
            WrappingMode::MirroredRepeat => Wrap::Mirror,
        });
        // With v = 1 − w, where w goes down: 1 − (offset + scale · w) = (1 − offset − scale) + scale · v.
        let offset = [offset[0], 1.0 - offset[1] - scale[1]];
        Some(TextureMap { offset, scale, wrap, ..TextureMap::new(image) })
    }

    /// Index of the image of a texture, read once.
    fn image(&mut self, material: &str, texture: &Texture<'a>) -> Option<usize> {
        let index = texture.source().index();
        if let Some(&known) = self.images_by_index.get(&index) {
            return known;
        }
        let found = match self.decode(index) {
            Ok(image) => {
                self.images.push(image);
                Some(self.images.len() - 1)
            }
            Err(problem) => {
                self.warn(
                    material,
                    &format!("image {index}: {problem}; the material's colour stands for it"),
                );
                None
            }
        };
        self.images_by_index.insert(index, found);
        found
    }

    fn decode(&self, index: usize) -> Result<Image, String> {
        let image = self.document.as_json().images.get(index).ok_or("it does not exist")?;
        let name = image.name.clone().or(image.uri.clone().filter(|uri| !uri.starts_with("data:")));
        let name = name.unwrap_or_else(|| format!("image {index}"));
        let decoded = match (&image.buffer_view, &image.uri) {
            (Some(view), _) => {
                let view = self.document.views().nth(view.value()).ok_or("its buffer view does not exist")?;
                Image::decode(name, self.resources.view(&view)?)
            }
            (None, Some(uri)) => Image::decode(name, &self.resources.read_uri(uri)?),
            (None, None) => return Err("it has no data".to_owned()),
        };
        decoded.map_err(|error| error.to_string())
    }

    fn warn(&mut self, material: &str, problem: &str) {
        self.warnings.push(format!("material {material}: {problem}"));
    }
}

/// The set of texture coordinates of a texture: that of its transformation counts more.
fn set_of(info: &Info<'_>) -> u32 {
    info.texture_transform().and_then(|transform| transform.tex_coord()).unwrap_or(info.tex_coord())
}

/// The mean of three values of each pixel.
fn mean(image: &Image, values: impl Fn([u8; 4]) -> [f64; 3]) -> [f64; 3] {
    let mut sums = [0.0; 3];
    for &pixel in image.pixels() {
        sums.iter_mut().zip(values(pixel)).for_each(|(sum, value)| *sum += value);
    }
    sums.map(|sum| sum / image.pixels().len() as f64)
}

/// The mean alpha of the pixels that are not wholly transparent, from 0 to 1; 1 if there are none.
fn mean_alpha(image: &Image) -> f64 {
    let (mut sum, mut count) = (0u64, 0u64);
    for pixel in image.pixels().iter().filter(|pixel| pixel[3] > 0) {
        sum += u64::from(pixel[3]);
        count += 1;
    }
    if count == 0 { 1.0 } else { sum as f64 / (255 * count) as f64 }
}
