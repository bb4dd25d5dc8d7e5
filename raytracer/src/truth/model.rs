//! A mesh in the place of its voxels.

use super::triangles::{TriangleHit, Triangles, Waiting};
use crate::ray::Ray;
use octvox_converter::{ConvertError, Look, Material, Mesh, MeshLook, WorldTransform};
use octvox_format::NormalCode;

/// A mesh made ready for rays, where its voxels are in unit space.
///
/// It does not depend on how fine the voxels are, so one does for all resolutions of a mesh whose longest axis fills the
/// cube. Meshes that were displaced when they were converted are not seen so here.
pub struct TruthModel<'m> {
    pub(super) triangles: Triangles,
    look: MeshLook<'m>,
    mesh: &'m Mesh,
    normal_code: Option<NormalCode>,
}

impl<'m> TruthModel<'m> {
    /// A mesh that was converted. `world` and `resolution` are those of the conversion's report, `crease_degrees` of its
    /// options.
    ///
    /// # Errors
    /// What the converter says of a mesh that it cannot place.
    pub fn new(
        mesh: &'m Mesh,
        world: WorldTransform,
        resolution: u32,
        crease_degrees: f64,
    ) -> Result<Self, ConvertError> {
        let look = MeshLook::new(mesh, crease_degrees)?;
        Ok(Self {
            triangles: Triangles::in_unit_space(mesh, world, resolution),
            look,
            mesh,
            normal_code: None,
        })
    }

    /// The same with normals that a file keeps in a code: what the code alone does to pictures.
    #[must_use]
    pub fn with_normal_code(self, code: NormalCode) -> Self {
        Self { normal_code: Some(code), ..self }
    }

    /// The first hit of a ray within two distances, or any, of what is not cut out.
    pub(super) fn search(
        &self,
        ray: &Ray,
        range: [f64; 2],
        is_any_enough: bool,
        waiting: &mut Waiting,
    ) -> Option<TriangleHit> {
        if self.look.has_cut_outs() {
            let is_there = |triangle, weights| self.look.at(triangle, all_three(weights)).is_some();
            self.triangles.search(ray, range, is_any_enough, is_there, waiting)
        } else {
            self.triangles.search(ray, range, is_any_enough, |_, _| true, waiting)
        }
    }

    /// What it looks like where a ray met it.
    pub(super) fn look(&self, hit: &TriangleHit) -> Option<Look> {
        let look = self.look.at(hit.triangle, all_three(hit.barycentric))?;
        let Some(code) = self.normal_code else { return Some(look) };
        let coded = code.decode(code.encode(look.normal.map(|part| part as f32)));
        Some(Look { normal: coded.map(f64::from), ..look })
    }

    /// The material of a triangle; of one without the first, as the converter does.
    pub(super) fn material(&self, triangle: usize) -> Option<&Material> {
        let number = self.mesh.triangle_materials().get(triangle).map_or(0, |&number| number as usize);
        self.mesh.materials().get(number)
    }
}

/// The weights of all corners.
fn all_three([second, third]: [f64; 2]) -> [f64; 3] {
    [1.0 - second - third, second, third]
}
