//! The truth that pictures of voxels are measured against: the same scenes, seen by the triangles that the voxels were made
//! of, one ray after the other, in double precision.
//!
//! What the ray tracer does for voxels is written here a second time, for triangles: rays of the camera, lamps, what
//! surfaces scatter, shadows. Only what leaves no room for opinion is shared: where samples are in a pixel, what the
//! background looks like, and how light is displayed. So pictures of both are compared pixel by pixel, and what differs is
//! what voxels, their levels of detail, their normals and their palette do.
//!
//! Mirrors, glass, light from around and depth of field are not simulated, see [`Unsupported`].
//!
//! ```no_run
//! use octvox_converter::{Options, convert, load_mesh};
//! use octvox_raytracer::scene::Scene;
//! use octvox_raytracer::truth::{Truth, TruthModel};
//! use octvox_raytracer::{Camera, DEFAULT_FOV, Lens, Octree, Tone};
//!
//! let mesh = load_mesh("bunny.obj".as_ref())?;
//! let (options, mut file) = (Options::default(), Vec::new());
//! let report = convert(&mesh, &options, &octvox_cli::Progress::hidden(), &mut file)?;
//! let octree = Octree::from_bytes(&file)?;
//! let camera = Camera::framing(&octree, 640.0 / 480.0, DEFAULT_FOV);
//!
//! let scene = Scene::of_model(&octree, &camera);
//! let models = [TruthModel::new(&mesh, report.world, report.resolution, options.crease_degrees)?];
//! let picture = Truth::new(&scene, &models).picture(&camera, &Lens::default(), [640, 480], 16, &Tone::default())?;
//! println!("{} pixels show the model", picture.hit_pixels);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod eye;
mod hierarchy;
mod lamp;
mod model;
mod picture;
mod shading;
mod triangles;

pub use model::TruthModel;
pub use picture::{TruthPicture, Unsupported};
pub use triangles::{TriangleHit, Triangles};

use crate::camera::{Camera, CameraError};
use crate::frame::FirstHit;
use crate::lens::Lens;
use crate::ray::Ray;
use crate::scene::{Ground, Instance, Scene, Similarity};
use eye::Eye;
use glam::DVec3;
use rayon::prelude::*;
use shading::{Surface, highlights};
use triangles::Waiting;

/// A scene seen by triangles.
pub struct Truth<'a> {
    scene: &'a Scene<'a>,
    models: &'a [TruthModel<'a>],
    /// Of each model of the scene, whether the materials of its file tell its highlights.
    has_own_highlights: Vec<bool>,
    /// The largest number that places an instance.
    largest: f64,
}

/// What the ray through the middle of a pixel meets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TruthHit {
    /// Distance along the ray in the scene, as that of [`FirstHit`]: from the eye, or with an orthographic camera from the
    /// plane through the eye. Infinite where nothing is met.
    pub distance: f64,
    /// Unit normal in the scene as the converter would store it: interpolated between corners, tilted by a normal map, on
    /// the side on which the mesh has it. Zero where nothing is met.
    pub normal: DVec3,
}

/// A place in the scene that a ray met.
#[derive(Debug, Clone, Copy)]
enum Met {
    Ground { distance: f64 },
    Model { instance: usize, hit: TriangleHit },
}

impl TruthHit {
    /// Nothing is met.
    pub const NONE: Self = Self { distance: f64::INFINITY, normal: DVec3::ZERO };
}

impl From<TruthHit> for FirstHit {
    /// No cells are visited, and there are no levels.
    fn from(hit: TruthHit) -> Self {
        Self { distance: hit.distance as f32, normal: hit.normal.as_vec3().to_array(), steps: 0, level: 0 }
    }
}

impl<'a> Truth<'a> {
    /// A scene as it is rendered. `models` are what its models were made of, in the same order: an instance of one that has
    /// none is not to be seen, and there is no picture of it.
    #[must_use]
    pub fn new(scene: &'a Scene<'a>, models: &'a [TruthModel<'a>]) -> Self {
        let has_own_highlights = scene.models.iter().map(|model| highlights(model.octree)).collect();
        let sizes = scene
            .instances
            .iter()
            .map(|Instance { placement, .. }| placement.translation.abs().max_element().max(placement.scale));
        Self { scene, models, has_own_highlights, largest: sizes.fold(0.0, f64::max) }
    }

    /// What the rays through the middles of pixels meet, row by row from the top; `size` is columns and rows. Of a lens with
    /// an opening the rays go through its middle.
    ///
    /// # Errors
    /// If the camera sees nothing.
    pub fn first_hits(
        &self,
        camera: &Camera,
        lens: &Lens,
        size: [u32; 2],
    ) -> Result<Vec<TruthHit>, CameraError> {
        let eye = Eye::new(camera, lens, size)?;
        let [width, height] = size.map(|size| size as usize);
        let hit = |waiting: &mut Waiting, place: usize| {
            let ray = eye.ray([(place % width) as f64 + 0.5, (place / width) as f64 + 0.5]);
            let Some(met) = self.first_met(&ray, waiting) else { return TruthHit::NONE };
            let Surface { normal, .. } = self.surface(&ray, &met);
            TruthHit { distance: met.distance(), normal }
        };
        Ok((0..width * height).into_par_iter().map_init(Waiting::default, hit).collect())
    }

    /// What a ray, of which the direction is a unit vector, meets first.
    fn first_met(&self, ray: &Ray, waiting: &mut Waiting) -> Option<Met> {
        let mut first = self.scene.ground.as_ref().and_then(|ground| ground_distance(ground, ray));
        let mut met = first.map(|distance| Met::Ground { distance });
        for (instance, (placement, model)) in self.instances().enumerate() {
            let Some(model) = model else { continue };
            let end = first.unwrap_or(f64::INFINITY);
            let found = model.search(&to_unit(placement, ray), [0.0, end], false, waiting);
            // Of two at the same distance the one that was there before counts.
            if let Some(hit) = found.filter(|hit| first.is_none_or(|first| hit.distance < first)) {
                first = Some(hit.distance);
                met = Some(Met::Model { instance, hit });
            }
        }
        met
    }

    /// Whether something is in the way of a ray, of which the direction is a unit vector, up to a distance. The ground is
    /// not in the way of what leaves it.
    fn is_blocked(&self, ray: &Ray, end: f64, leaves_ground: bool, waiting: &mut Waiting) -> bool {
        let ground = self.scene.ground.as_ref().filter(|_| !leaves_ground);
        ground.and_then(|ground| ground_distance(ground, ray)).is_some_and(|distance| distance < end)
            || self.instances().any(|(placement, model)| {
                let ray = to_unit(placement, ray);
                model.is_some_and(|model| model.search(&ray, [0.0, end], true, waiting).is_some())
            })
    }

    fn instances(&self) -> impl Iterator<Item = (&Similarity, Option<&TruthModel<'a>>)> {
        self.scene.instances.iter().map(|Instance { model, placement }| (placement, self.models.get(*model)))
    }
}

impl Met {
    fn distance(&self) -> f64 {
        match self {
            Self::Ground { distance } => *distance,
            Self::Model { hit, .. } => hit.distance,
        }
    }
}

/// The ray in the unit space of an instance; distances along it are those in the scene.
fn to_unit(placement: &Similarity, ray: &Ray) -> Ray {
    let direction = placement.direction_to_unit(ray.direction) / placement.scale;
    Ray { origin: placement.to_unit(ray.origin), direction }
}

fn ground_distance(ground: &Ground, ray: &Ray) -> Option<f64> {
    let distance = (ground.height - ray.origin.y) / ray.direction.y;
    (0.0..f64::INFINITY).contains(&distance).then_some(distance)
}
