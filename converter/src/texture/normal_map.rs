//! Textures that tilt normals.

use super::footprint::Gradients;
use super::lookup::Lookup;
use crate::material::NormalMapKind;
use crate::normals::{FixedNormal, to_fixed};
use crate::vector::{cross, dot, unit};

/// The directions in which texture coordinates grow over a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Tangents {
    along_u: [f64; 3],
    along_v: [f64; 3],
}

impl Tangents {
    /// `None` if the texture is collapsed to a line or a point on the triangle.
    pub(crate) fn new(gradients: &Gradients) -> Option<Self> {
        let Gradients([u, v]) = *gradients;
        let normal = cross(u, v);
        // Along these, one of the coordinates grows and the other stays the same; they are the dual basis of the gradients.
        // Where the texture is mirrored, `normal` points the other way and both directions are right all the same.
        Some(Self { along_u: unit(cross(v, normal))?, along_v: unit(cross(normal, u))? })
    }

    /// The directions at right angles to a unit normal and to each other, as near as can be to those on the triangle: first
    /// that of u, then that of v. The handedness is that of the texture.
    fn beside(&self, normal: [f64; 3]) -> Option<[[f64; 3]; 2]> {
        let lean = dot(self.along_u, normal);
        let u = unit([0, 1, 2].map(|axis| self.along_u[axis] - lean * normal[axis]))?;
        let v = cross(normal, u);
        Some([u, if dot(v, self.along_v) < 0.0 { v.map(|component| -component) } else { v }])
    }
}

/// A normal map on a triangle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NormalLookup<'a> {
    pub lookup: Lookup<'a>,
    pub kind: NormalMapKind,
    pub tangents: Tangents,
}

impl NormalLookup<'_> {
    /// The normal at these texture coordinates, tilted by the map.
    pub(crate) fn tilted(&self, normal: FixedNormal, coordinates: [f64; 2]) -> FixedNormal {
        self.try_tilted(normal, coordinates).map_or(normal, to_fixed)
    }

    fn try_tilted(&self, normal: FixedNormal, coordinates: [f64; 2]) -> Option<[f64; 3]> {
        let normal = unit(normal.map(f64::from))?;
        let [u, v] = self.tangents.beside(normal)?;
        let [along_u, along_v, outward] = match self.kind {
            NormalMapKind::Tangent { strength } => {
                let [x, y, z] =
                    self.lookup.see(coordinates).color().map(|value| 2.0 * f64::from(value) - 1.0);
                [strength * x, strength * y, z]
            }
            NormalMapKind::Height { multiplier } => {
                let [rise_u, rise_v] = self.slopes(coordinates);
                [-multiplier * rise_u, -multiplier * rise_v, 1.0]
            }
        };
        unit([0, 1, 2].map(|axis| along_u * u[axis] + along_v * v[axis] + outward * normal[axis]))
    }

    /// Rise of the height for each unit of texture coordinates, along u and v: differences over the width of a probe.
    fn slopes(&self, coordinates: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|axis| {
            let step = self.lookup.probe_size[axis];
            let height = |side: f64| {
                let mut shift = [0.0; 2];
                shift[axis] = side * step;
                f64::from(self.lookup.see_beside(coordinates, shift).number())
            };
            (height(0.5) - height(-0.5)) / step * f64::from(self.lookup.scale()[axis])
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texture::pyramid::{Encoding, Pyramid};
    use crate::{Image, TextureMap};

    const UP: FixedNormal = [0, 0, 16_384];

    fn tilted(
        image: &Image,
        map: &TextureMap,
        kind: NormalMapKind,
        gradients: Gradients,
        normal: FixedNormal,
    ) -> [f64; 3] {
        let pyramid = Pyramid::new(image, Encoding::Numbers, false);
        let lookup = Lookup::new(&pyramid, map, &gradients);
        let tangents = Tangents::new(&gradients).unwrap();
        NormalLookup { lookup, kind, tangents }
            .tilted(normal, [0.5; 2])
            .map(|component| f64::from(component) / 16_384.0)
    }

    fn close(found: [f64; 3], expected: [f64; 3]) -> bool {
        (0..3).all(|axis| (found[axis] - expected[axis]).abs() < 6e-3)
    }

    #[test]
    fn tangent_space_is_that_of_the_texture() {
        // Towards u (0.6) and v (0.48), and out of the surface (0.64).
        let encode = |value: f64| ((value + 1.0) * 127.5).round() as u8;
        let image = Image::new("tilt", 1, 1, vec![[encode(0.6), encode(0.48), encode(0.64), 255]]).unwrap();
        let (map, kind) = (TextureMap::new(0), NormalMapKind::Tangent { strength: 1.0 });
        let tilt = |u, v| tilted(&image, &map, kind, Gradients([u, v]), UP);
        let (x, y) = ([0.1, 0.0, 0.0], [0.0, 0.1, 0.0]);
        let negative = |vector: [f64; 3]| vector.map(|component| -component);
        assert!(close(tilt(x, y), [0.6, 0.48, 0.64]));
        assert!(close(tilt(y, negative(x)), [-0.48, 0.6, 0.64]), "turned by a quarter");
        assert!(close(tilt(negative(x), y), [-0.6, 0.48, 0.64]), "mirrored");
        assert!(close(tilt(x, negative(y)), [0.6, -0.48, 0.64]), "mirrored the other way");
        // The same, on a surface that looks down and whose texture was turned over with it.
        let below = tilted(&image, &map, kind, Gradients([x, y]), [0, 0, -16_384]);
        assert!(close(below, [0.6, 0.48, -0.64]));
        let flat = tilted(&image, &map, NormalMapKind::Tangent { strength: 0.0 }, Gradients([x, y]), UP);
        assert!(close(flat, [0.0, 0.0, 1.0]));
    }

    #[test]
    fn a_height_that_rises_evenly_is_an_inclined_plane() {
        // From 0 at the left (and bottom) of the image to about 1 at the other end.
        let ramp = |value: fn(u32, u32) -> u32| {
            let pixels = (0..64u32).flat_map(|row| (0..64).map(move |column| value(column, 63 - row)));
            Image::new("ramp", 64, 64, pixels.map(|value| [4 * value as u8; 4]).collect()).unwrap()
        };
        let slope: f64 = 4.0 * 64.0 / 255.0;
        let gradients = Gradients([[0.01, 0.0, 0.0], [0.0, 0.01, 0.0]]);
        let kind = |multiplier| NormalMapKind::Height { multiplier };
        let map = TextureMap::new(0);
        for multiplier in [1.0, -0.5, 3.0] {
            let rise = slope * multiplier;
            let length = (1.0 + rise * rise).sqrt();
            let found = tilted(&ramp(|column, _| column), &map, kind(multiplier), gradients, UP);
            assert!(close(found, [-rise / length, 0.0, 1.0 / length]), "{found:?}");
            let found = tilted(&ramp(|_, row| row), &map, kind(multiplier), gradients, UP);
            assert!(close(found, [0.0, -rise / length, 1.0 / length]), "{found:?}");
        }
        // Half the way up in the same distance.
        let map = TextureMap { scale: [0.5, 0.5], ..map };
        let found = tilted(&ramp(|column, _| column), &map, kind(2.0), gradients, UP);
        let length = (1.0 + slope * slope).sqrt();
        assert!(close(found, [-slope / length, 0.0, 1.0 / length]), "{found:?}");
    }

    #[test]
    fn a_texture_without_extent_has_no_tangents() {
        let x = [1.0, 0.0, 0.0];
        for [u, v] in [[[0.0; 3]; 2], [x, x], [x, [0.0; 3]]] {
            assert_eq!(Tangents::new(&Gradients([u, v])), None);
        }
    }
}
