//! What is to be seen: models and where they stand, lamps, ground and background.
//!
//! The *scene* has one space. A model's unit space is placed in it by a [`Similarity`]; of a scene made of a model alone
//! ([`Scene::of_model`]), it is the model's unit space.

mod background;
mod light;
mod similarity;
pub(crate) mod studio;

pub use background::{Background, Surroundings};
pub use light::{Light, Source};
pub(crate) use light::{across, on_disk};
pub use similarity::Similarity;

use crate::color::{Light3, to_linear};
use crate::octree::Octree;
use glam::Vec3;
use octvox_format::Material;

/// Models, lamps, ground and background.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene<'a> {
    /// What stands in the scene, any number of times.
    pub models: Vec<Model<'a>>,
    /// Where it stands.
    pub instances: Vec<Instance>,
    /// A plane without end, below it all.
    pub ground: Option<Ground>,
    /// The lamps.
    pub lights: Vec<Light>,
    /// Light from everywhere.
    pub ambient: Ambient,
    /// What is seen beyond the models.
    pub background: Background,
}

/// An octree, and what it is made of.
#[derive(Debug, Clone)]
pub struct Model<'a> {
    /// Its structure.
    pub octree: &'a Octree,
    /// What palette index `k + 1` looks like.
    pub surfaces: Vec<SurfaceMaterial>,
}

/// A model in the scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instance {
    /// Which of the scene's models.
    pub model: usize,
    /// Where it stands.
    pub placement: Similarity,
}

/// A horizontal plane without end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ground {
    /// Its y coordinate.
    pub height: f64,
    /// What its squares look like, in turns.
    pub surfaces: [SurfaceMaterial; 2],
    /// The edge of a square; one corner is at the origin.
    pub square: f64,
}

/// Light that comes from all around.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ambient {
    /// Amount of light.
    pub color: Light3,
    /// Within this distance, what is in the way keeps it off; without one, it arrives everywhere.
    pub occlusion: Option<f32>,
    /// Whether things that shine by themselves light others.
    pub glow: bool,
}

/// What a surface does with light; linear amounts, each from 0 to 1 unless said otherwise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceMaterial {
    /// Share that is scattered in all directions.
    pub diffuse: Light3,
    /// Strength of the highlight.
    pub specular: Light3,
    /// Exponent of the highlight (Phong 1975), 0 or more.
    pub shininess: f32,
    /// Share that is mirrored if one looks straight at it.
    pub reflectivity: Light3,
    /// Share that passes into the material.
    pub transparency: f32,
    /// Speed of light outside over that inside, above 0.
    pub refraction_index: f32,
    /// What the inside absorbs, 0 or more: after a way of length `s` in the scene, `exp(−a s)` is left.
    pub absorption: Vec3,
    /// Light given off by itself, 0 or more.
    pub emission: Light3,
}

impl<'a> Scene<'a> {
    /// A model alone, in its unit space, under three lamps about the camera, of which the brightest makes shadows.
    #[must_use]
    pub fn of_model(octree: &'a Octree, camera: &crate::Camera) -> Self {
        let mut scene = Self {
            models: vec![Model::new(octree)],
            instances: vec![Instance { model: 0, placement: Similarity::IDENTITY }],
            ground: None,
            lights: Vec::new(),
            ambient: studio::AMBIENT,
            background: studio::BACKGROUND,
        };
        scene.light_as_studio(camera);
        scene
    }

    /// Puts three lamps about the camera: a warm one from the upper left, a cool one from the right, a white one from
    /// behind. The warm one makes shadows.
    pub fn light_as_studio(&mut self, camera: &crate::Camera) {
        self.lights = camera.axes().map_or_else(Vec::new, |axes| studio::lights(axes).into());
    }
}

/// Highlights of models whose file says nothing of them: strength and exponent.
pub(crate) const HIGHLIGHT: (f32, f32) = (0.22, 32.0);

impl SurfaceMaterial {
    /// Scatters nothing.
    pub(crate) const BLACK: Self = Self {
        diffuse: Vec3::ZERO,
        specular: Vec3::ZERO,
        shininess: 0.0,
        reflectivity: Vec3::ZERO,
        transparency: 0.0,
        refraction_index: 1.0,
        absorption: Vec3::ZERO,
        emission: Vec3::ZERO,
    };

    /// An opaque material without highlight.
    #[must_use]
    pub fn matte(diffuse: Light3) -> Self {
        Self { diffuse, ..Self::BLACK }
    }

    /// A material of a file. `unit` is the length in the scene of the file's unit of length, for what is absorbed on the
    /// way.
    #[must_use]
    pub fn new(material: &Material, unit: f64) -> Self {
        let linear = |color: [u8; 3]| Vec3::from_array(color.map(to_linear));
        let share = |share: u8| f32::from(share) / 255.0;
        let specular = linear(material.specular);
        let mean = specular.element_sum() / 3.0;
        // Metals mirror in the colour of their highlights.
        let tint = if mean > 0.0 { specular / mean } else { Vec3::ONE };
        Self {
            diffuse: linear(material.diffuse),
            specular,
            shininess: material.shininess,
            reflectivity: (tint * share(material.reflectivity)).min(Vec3::ONE),
            transparency: share(material.transparency),
            refraction_index: material.refraction_index,
            absorption: Vec3::from_array(material.absorption) / unit as f32,
            emission: Vec3::from_array(material.emission),
        }
    }

    /// Whether no more than its colour and its highlight is to be seen of it.
    #[must_use]
    pub fn is_plain(&self) -> bool {
        !self.is_mirror() && !self.is_transparent() && !self.is_emissive()
    }

    /// Whether light is mirrored.
    #[must_use]
    pub fn is_mirror(&self) -> bool {
        self.reflectivity != Vec3::ZERO
    }

    /// Whether light passes.
    #[must_use]
    pub fn is_transparent(&self) -> bool {
        self.transparency > 0.0
    }

    /// Whether it shines by itself.
    #[must_use]
    pub fn is_emissive(&self) -> bool {
        self.emission != Vec3::ZERO
    }
}

impl<'a> Model<'a> {
    /// An octree with the materials of its file. If none of them has a highlight, all get a faint one.
    #[must_use]
    pub fn new(octree: &'a Octree) -> Self {
        Self::scaled(octree, 1.0)
    }

    /// As [`Model::new`], for instances that are larger by a factor than its unit space.
    #[must_use]
    pub fn scaled(octree: &'a Octree, scale: f64) -> Self {
        let materials = octree.palette().materials();
        // Absorption is per world unit, or per edge of the cube if its place in the world is unknown.
        let edge = octree.world().map_or(1.0, |world| world.voxel_size * f64::from(octree.resolution()));
        let mut surfaces: Vec<_> =
            materials.iter().map(|material| SurfaceMaterial::new(material, scale / edge)).collect();
        if materials.iter().all(|material| material.specular == [0; 3]) {
            for surface in &mut surfaces {
                surface.specular = Vec3::splat(HIGHLIGHT.0);
                surface.shininess = HIGHLIGHT.1;
            }
        }
        Self { octree, surfaces }
    }
}

impl PartialEq for Model<'_> {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self.octree, other.octree) && self.surfaces == other.surfaces
    }
}
