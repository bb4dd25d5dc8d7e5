//! Writes a scene as Wavefront OBJ and MTL text.

use crate::color::WHITE;
use crate::mesh::{Corner, MaterialId};
use crate::scene::Scene;
use glam::{DVec2, DVec3};
use std::io::{self, Write};

/// Writes the OBJ file. Colours stand behind all positions (`v x y z r g b`) if any of them is not white, since readers
/// expect them on every vertex or on none.
///
/// # Errors
/// If `out` fails.
pub fn write_obj(scene: &Scene, out: &mut impl Write) -> io::Result<()> {
    let mesh = &scene.mesh;
    writeln!(out, "# octvox sample scene: {}", scene.title)?;
    writeln!(out, "# {} triangles, y is up", mesh.triangle_count())?;
    writeln!(out, "mtllib {}.mtl", scene.name)?;
    let colored = mesh.vertices.iter().any(|vertex| vertex.color != WHITE);
    for vertex in &mesh.vertices {
        write!(out, "v {}", decimals(vertex.position, 4))?;
        if colored {
            write!(out, " {}", decimals(vertex.color, 3))?;
        }
        writeln!(out)?;
    }
    for normal in &mesh.normals {
        writeln!(out, "vn {}", decimals(*normal, 3))?;
    }
    for DVec2 { x, y } in &mesh.uvs {
        writeln!(out, "vt {} {}", decimal(*x, 4), decimal(*y, 4))?;
    }
    let mut order: Vec<usize> = (0..mesh.faces.len()).collect();
    order.sort_by_key(|&index| mesh.faces[index].material);
    let mut current = None;
    for face in order.into_iter().map(|index| &mesh.faces[index]) {
        if current != Some(face.material) {
            let MaterialId(index) = face.material;
            writeln!(out, "usemtl {}", scene.materials[index].name)?;
            current = Some(face.material);
        }
        write!(out, "f")?;
        for corner in &face.corners {
            write_corner(corner, out)?;
        }
        writeln!(out)?;
    }
    Ok(())
}

fn write_corner(corner: &Corner, out: &mut impl Write) -> io::Result<()> {
    let vertex = corner.vertex + 1;
    match (corner.uv, corner.normal) {
        (None, None) => write!(out, " {vertex}"),
        (Some(uv), None) => write!(out, " {vertex}/{}", uv + 1),
        (None, Some(normal)) => write!(out, " {vertex}//{}", normal + 1),
        (Some(uv), Some(normal)) => write!(out, " {vertex}/{}/{}", uv + 1, normal + 1),
    }
}

/// Writes the MTL file.
///
/// # Errors
/// If `out` fails.
pub fn write_mtl(scene: &Scene, out: &mut impl Write) -> io::Result<()> {
    writeln!(out, "# octvox sample scene: {}", scene.title)?;
    for material in &scene.materials {
        writeln!(out, "\nnewmtl {}", material.name)?;
        writeln!(out, "Kd {}", decimals(material.diffuse, 3))?;
        writeln!(out, "Ks {}", decimals(material.specular, 3))?;
        writeln!(out, "Ns {}", decimal(material.shininess, 0))?;
        if material.emission != DVec3::ZERO {
            writeln!(out, "Ke {}", decimals(material.emission, 3))?;
        }
        if let Some(texture) = &material.texture {
            writeln!(out, "map_Kd {texture}")?;
        }
    }
    Ok(())
}

/// Three numbers with a fixed number of decimals.
fn decimals(values: DVec3, places: usize) -> String {
    values.to_array().map(|value| decimal(value, places)).join(" ")
}

/// A number with up to `places` decimals: trailing zeros are left out, and zero has no sign.
fn decimal(value: f64, places: usize) -> String {
    let text = format!("{value:.places$}");
    let short = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if short == "-0" { "0".to_owned() } else { short.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Material;
    use crate::primitives::prism;

    #[test]
    fn numbers_are_short_and_zero_has_no_sign() {
        for (value, places, expected) in [
            (0.5, 4, "0.5"),
            (-0.00001, 4, "0"),
            (1.0 / 3.0, 3, "0.333"),
            (-2.0, 3, "-2"),
            (100.0, 0, "100"),
            (99.99999, 4, "100"),
        ] {
            assert_eq!(decimal(value, places), expected);
        }
    }

    #[test]
    fn a_triangular_prism_is_written_as_specified() {
        let mut scene = Scene::new("wedge", "a wedge");
        let stone = scene.material(Material::matte("stone", DVec3::splat(0.5)));
        let polygon = [DVec2::ZERO, DVec2::X, DVec2::Y];
        scene.add(prism(&polygon, 2.0).of(stone));
        let mut text = Vec::new();
        write_obj(&scene, &mut text).unwrap();
        let text = String::from_utf8(text).unwrap();
        let expected = "# octvox sample scene: a wedge\n# 8 triangles, y is up\nmtllib wedge.mtl\n\
            v 0 0 1\nv 1 0 1\nv 0 1 1\nv 0 0 -1\nv 1 0 -1\nv 0 1 -1\n\
            vn 0 0 1\nvn 0 0 -1\nvn 0 -1 0\nvn 0.707 0.707 0\nvn -1 0 0\nusemtl stone\n\
            f 1//1 2//1 3//1\nf 6//2 5//2 4//2\nf 2//3 1//3 4//3 5//3\nf 3//4 2//4 5//4 6//4\nf 1//5 3//5 6//5 4//5\n";
        assert_eq!(text, expected);
    }

    #[test]
    fn a_material_is_written_with_what_it_has() {
        let mut scene = Scene::new("lamp", "a lamp");
        let lamp = Material::matte("lamp", DVec3::new(1.0, 0.5, 0.25));
        scene.material(lamp.glossy(DVec3::splat(0.4), 50.0).glowing(DVec3::X).textured("lamp.png"));
        let mut text = Vec::new();
        write_mtl(&scene, &mut text).unwrap();
        let expected = "# octvox sample scene: a lamp\n\nnewmtl lamp\nKd 1 0.5 0.25\nKs 0.4 0.4 0.4\nNs 50\n\
            Ke 1 0 0\nmap_Kd lamp.png\n";
        assert_eq!(String::from_utf8(text).unwrap(), expected);
    }
}
