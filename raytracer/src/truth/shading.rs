//! What a point of a surface scatters to the eye, in double precision.

use super::lamp::arriving;
use super::triangles::Waiting;
use super::{Met, Truth};
use crate::octree::Octree;
use crate::ray::Ray;
use crate::sampling::{hashed, sample_2d};
use crate::scene::{HIGHLIGHT, SurfaceMaterial};
use glam::DVec3;

/// A point that a ray met, and what is there.
#[derive(Debug, Clone, Copy)]
pub(super) struct Surface {
    position: DVec3,
    /// Unit normal as the converter would store it, on the side on which the mesh has it.
    pub normal: DVec3,
    /// Unit normal of the plane, on either side; zero if the triangle is too thin to have one.
    plane: DVec3,
    diffuse: DVec3,
    specular: DVec3,
    shininess: f64,
    is_ground: bool,
}

/// A ray from the eye, for points of lamps that are spread well over the samples of a pixel.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    /// Column and row of the pixel.
    pub pixel: [u32; 2],
    /// Number of the sample.
    pub number: u32,
    /// Rays to each lamp that has an extent.
    pub lamp_points: u32,
}

/// Origins of rays are moved off the plane that they leave by so many roundings of the largest number involved.
///
/// A point by its weights is off the plane by three products and two sums in unit space; turned, scaled, moved, and brought
/// to unit space again by about as many operations more. None of them is off by more than one rounding of the largest
/// coordinate, and a factor of four is left.
const ROUNDINGS: f64 = 128.0;

/// Whether the materials of a file tell highlights; if not, all get the same faint one.
pub(super) fn highlights(octree: &Octree) -> bool {
    octree.palette().materials().iter().any(|material| material.specular != [0; 3])
}

impl Truth<'_> {
    /// What is where a ray met something.
    pub(super) fn surface(&self, ray: &Ray, met: &Met) -> Surface {
        match met {
            Met::Ground { distance } => self.of_ground(ray.origin + ray.direction * *distance),
            Met::Model { instance, hit } => {
                let instance = &self.scene.instances[*instance];
                let (placement, model) = (&instance.placement, &self.models[instance.model]);
                let look = model.look(hit);
                // Of what is met, the look is known.
                let normal = look.map_or(hit.normal, |look| DVec3::from_array(look.normal));
                let diffuse = look.map_or(DVec3::ZERO, |look| DVec3::from_array(look.diffuse));
                let (specular, shininess) = self.highlight(instance.model, hit.triangle);
                Surface {
                    position: placement.to_scene(hit.point),
                    normal: placement.rotation * normal,
                    plane: placement.rotation * hit.normal,
                    diffuse,
                    specular,
                    shininess,
                    is_ground: false,
                }
            }
        }
    }

    fn of_ground(&self, position: DVec3) -> Surface {
        let material = self.scene.ground.as_ref().map_or(SurfaceMaterial::BLACK, |ground| {
            let number = |coordinate: f64| (coordinate / ground.square).floor();
            ground.surfaces[usize::from((number(position.x) + number(position.z)).rem_euclid(2.0) == 1.0)]
        });
        Surface {
            position,
            normal: DVec3::Y,
            plane: DVec3::Y,
            diffuse: material.diffuse.as_dvec3(),
            specular: material.specular.as_dvec3(),
            shininess: f64::from(material.shininess),
            is_ground: true,
        }
    }

    /// Strength and exponent of the highlight of a triangle of a model.
    fn highlight(&self, model: usize, triangle: usize) -> (DVec3, f64) {
        if !self.has_own_highlights[model] {
            return (DVec3::splat(f64::from(HIGHLIGHT.0)), f64::from(HIGHLIGHT.1));
        }
        let Some(material) = self.models[model].material(triangle) else { return (DVec3::ZERO, 0.0) };
        (DVec3::from_array(material.specular.map(to_linear)), material.shininess.max(0.0))
    }

    /// The light that a point scatters to where `to_eye`, a unit vector, leads: of each lamp that it faces and that nothing is
    /// in the way of, `diffuse · cosine` and a highlight as Phong has it (1975); and of the light from around, `diffuse`.
    ///
    /// Both sides of a surface look alike. The eye's side is told by the plane of the triangle; where the normal that is
    /// interpolated leads away from the eye all the same, at a silhouette, it is turned until it just does not. A lamp behind
    /// the plane is hidden by the triangle itself.
    pub(super) fn scattered(
        &self,
        surface: &Surface,
        to_eye: DVec3,
        sample: Sample,
        waiting: &mut Waiting,
    ) -> DVec3 {
        let side = if surface.plane == DVec3::ZERO { surface.normal } else { surface.plane };
        let side = if side.dot(to_eye) < 0.0 { -side } else { side };
        let normal = if surface.normal.dot(side) < 0.0 { -surface.normal } else { surface.normal };
        let facing = normal.dot(to_eye);
        let normal = if facing < 0.0 { (normal - to_eye * facing).normalize_or(to_eye) } else { normal };

        let mut light = self.scene.ambient.color.as_dvec3() * surface.diffuse;
        for (number, lamp) in self.scene.lights.iter().enumerate() {
            let is_soft = lamp.shadow && lamp.is_soft();
            let points = if is_soft { sample.lamp_points } else { 1 };
            let mut from_lamp = DVec3::ZERO;
            for point in 0..points {
                let chosen = is_soft.then(|| {
                    let [x, y] = sample.pixel;
                    let seed = hashed(hashed(hashed(x, 0x7247), y), number as u32);
                    sample_2d(sample.number * points + point, seed).as_dvec2()
                });
                let arriving = arriving(lamp, surface.position, chosen);
                let facing = normal.dot(arriving.towards);
                if facing <= 0.0 || arriving.amount == DVec3::ZERO {
                    continue;
                }
                if lamp.shadow && self.is_dark(surface, side, arriving.towards, arriving.distance, waiting) {
                    continue;
                }
                let mirrored = normal * (2.0 * facing) - arriving.towards;
                let highlight = mirrored.dot(to_eye).clamp(0.0, 1.0);
                let highlight = if highlight > 0.0 { highlight.powf(surface.shininess) } else { 0.0 };
                from_lamp += arriving.amount * (surface.diffuse * facing + surface.specular * highlight);
            }
            light += from_lamp / f64::from(points);
        }
        light
    }

    /// Whether something is between a point and a lamp. `side` is the plane's normal on the eye's side.
    fn is_dark(
        &self,
        surface: &Surface,
        side: DVec3,
        towards: DVec3,
        distance: f64,
        waiting: &mut Waiting,
    ) -> bool {
        if side.dot(towards) <= 0.0 {
            return true;
        }
        let largest = surface.position.abs().max_element().max(self.largest);
        let origin = surface.position + side * (ROUNDINGS * f64::EPSILON * largest);
        self.is_blocked(&Ray { origin, direction: towards }, distance, surface.is_ground, waiting)
    }
}

/// The amount of light that a displayed value from 0 to 1 stands for (sRGB, IEC 61966-2-1).
fn to_linear(displayed: f64) -> f64 {
    let value = displayed.clamp(0.0, 1.0);
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}
