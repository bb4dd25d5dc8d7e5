//! Writes the sample scenes of octvox: models built from formulas, as OBJ, MTL and PNG files.

mod ball;
mod coil;
mod color;
mod curve;
mod detail;
mod globe;
mod knots;
mod lighthouse;
mod material;
mod mesh;
mod noise;
mod normals;
mod obj;
mod placement;
mod primitives;
mod scene;
mod shell;
mod sky;
#[cfg(test)]
mod topology;
mod tree;
mod trigonometry;

use anyhow::Context;
use clap::{Parser, ValueEnum};
use detail::Detail;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{EncodableLayout, ImageBuffer, PixelWithColorType};
use octvox_cli::{print_line, write_atomically};
use scene::{Scene, Texture};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Write the sample scenes as OBJ, MTL and PNG files
#[derive(Debug, Parser)]
#[command(
    version,
    after_help = "Example:\n  octvox-samples shell knots -o finer --detail 4\n      \
                  writes finer/shell.obj, finer/shell.mtl, finer/knots.obj and finer/knots.mtl"
)]
struct Arguments {
    /// Scenes to write
    #[arg(value_name = "SCENE", value_enum, default_value = "all")]
    scenes: Vec<Choice>,
    /// Folder for the files, created if it is missing
    #[arg(short, long, value_name = "FOLDER", default_value = "samples/models")]
    output: PathBuf,
    /// Segments along each curve, as a multiple of the committed files'
    #[arg(long, value_name = "N", default_value_t = Detail::COMMITTED.0, value_parser = clap::value_parser!(u8).range(1..=16))]
    detail: u8,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Choice {
    /// A sea shell on rippled sand
    Shell,
    /// A small island with a lighthouse
    Lighthouse,
    /// Woven bands around linked trefoil knots
    Knots,
    /// A textured globe on a stand
    Globe,
    /// A broad-leaved tree
    Tree,
    /// A conifer
    Pine,
    /// A sphere
    Ball,
    /// All directions of a studio at dusk, a picture alone
    Sky,
    /// Everything
    All,
}

/// Makes a scene.
type Builder = fn(Detail) -> Scene;

impl Choice {
    fn builders(self) -> &'static [Builder] {
        match self {
            Self::Shell => &[shell::build],
            Self::Lighthouse => &[lighthouse::build],
            Self::Knots => &[knots::build],
            Self::Globe => &[globe::build],
            Self::Tree => &[tree::build_broad_leaved],
            Self::Pine => &[tree::build_conifer],
            Self::Ball => &[ball::build],
            Self::Sky => &[],
            Self::All => &[
                shell::build,
                lighthouse::build,
                knots::build,
                globe::build,
                tree::build_broad_leaved,
                tree::build_conifer,
                ball::build,
            ],
        }
    }
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    octvox_cli::run(|| {
        std::fs::create_dir_all(&arguments.output)
            .with_context(|| format!("{}: cannot create the folder", arguments.output.display()))?;
        for choice in &arguments.scenes {
            for build in choice.builders() {
                write_scene(&build(Detail(arguments.detail)), &arguments.output)?;
            }
            if matches!(choice, Choice::Sky | Choice::All) {
                write_picture(&sky::paint(), &arguments.output.join("sky.png"))?;
            }
        }
        Ok(())
    })
}

/// Writes the files of a scene into `folder` and prints a line for each.
fn write_scene(scene: &Scene, folder: &Path) -> anyhow::Result<()> {
    let path = folder.join(format!("{}.obj", scene.name));
    write_atomically(&path, |out| Ok(obj::write_obj(scene, out)?))?;
    report(&path, &format!("{} triangles", scene.mesh.triangle_count()))?;
    let path = folder.join(format!("{}.mtl", scene.name));
    write_atomically(&path, |out| Ok(obj::write_mtl(scene, out)?))?;
    report(&path, &format!("{} materials", scene.materials.len()))?;
    for Texture { name, image } in &scene.textures {
        write_picture(image, &folder.join(name))?;
    }
    Ok(())
}

/// Writes a picture and prints a line for it.
fn write_picture<P>(picture: &ImageBuffer<P, Vec<P::Subpixel>>, path: &Path) -> anyhow::Result<()>
where
    P: PixelWithColorType,
    [P::Subpixel]: EncodableLayout,
{
    write_atomically(path, |out| {
        let encoder = PngEncoder::new_with_quality(out, CompressionType::Best, FilterType::Adaptive);
        Ok(picture.write_with_encoder(encoder)?)
    })?;
    report(path, &format!("{} x {} pixels", picture.width(), picture.height()))
}

fn report(path: &Path, content: &str) -> anyhow::Result<()> {
    let bytes = std::fs::metadata(path).with_context(|| path.display().to_string())?.len();
    print_line(&format!("{}: {content}, {bytes} bytes", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use std::collections::HashSet;
    use std::sync::LazyLock;

    /// Every scene at the committed detail and at a finer one, built once.
    fn scenes() -> &'static [Scene] {
        static SCENES: LazyLock<Vec<Scene>> = LazyLock::new(|| {
            let with_detail = |detail| Choice::All.builders().iter().map(move |build| build(detail));
            [Detail::COMMITTED, Detail(2)].into_iter().flat_map(with_detail).collect()
        });
        &SCENES
    }

    #[test]
    fn indices_are_valid_and_numbers_finite() {
        for Scene { name, mesh, materials, .. } in scenes() {
            assert!(mesh.vertices.iter().all(|vertex| vertex.position.is_finite()), "{name}");
            let in_range = |color: DVec3| color.min_element() >= 0.0 && color.max_element() <= 1.0;
            assert!(mesh.vertices.iter().all(|vertex| in_range(vertex.color)), "{name}");
            assert!(materials.iter().all(|material| in_range(material.diffuse)), "{name}");
            for face in &mesh.faces {
                assert!(face.material.0 < materials.len(), "{name}");
                let distinct: HashSet<usize> = face.corners.iter().map(|corner| corner.vertex).collect();
                assert!(distinct.len() >= 3 && distinct.len() == face.corners.len(), "{name}");
                for corner in &face.corners {
                    assert!(corner.vertex < mesh.vertices.len(), "{name}");
                    assert!(corner.normal.is_some_and(|normal| normal < mesh.normals.len()), "{name}");
                    assert!(corner.uv.is_none_or(|uv| uv < mesh.uvs.len()), "{name}");
                }
            }
        }
    }

    #[test]
    fn normals_have_unit_length_and_face_outward() {
        for Scene { name, mesh, .. } in scenes() {
            assert!(mesh.normals.iter().all(|normal| normal.is_normalized()), "{name}");
            for face in &mesh.faces {
                let flat = normals::of_polygon(mesh.outline(face));
                let mean: DVec3 = face
                    .corners
                    .iter()
                    .filter_map(|corner| corner.normal)
                    .map(|normal| mesh.normals[normal])
                    .sum();
                assert!(mean.dot(flat) > 0.0, "{name}: near {}", mesh.center(face));
            }
        }
    }

    #[test]
    fn surfaces_are_closed_and_enclose_a_volume() {
        for Scene { name, mesh, .. } in scenes() {
            assert_eq!(topology::open_edges(mesh), 0, "{name}");
            assert!(topology::volume(mesh) > 0.0, "{name}");
        }
    }

    #[test]
    fn materials_have_names_of_their_own_and_refer_to_textures_that_exist() {
        for Scene { name, materials, textures, .. } in scenes() {
            let names: HashSet<&str> = materials.iter().map(|material| material.name.as_str()).collect();
            assert_eq!(names.len(), materials.len(), "{name}");
            for texture in materials.iter().filter_map(|material| material.texture.as_ref()) {
                assert!(textures.iter().any(|known| known.name == *texture), "{name}: {texture}");
            }
        }
    }

    #[test]
    fn building_twice_gives_the_same_text() {
        for build in Choice::All.builders() {
            let text = || {
                let mut text = Vec::new();
                obj::write_obj(&build(Detail::COMMITTED), &mut text).unwrap();
                text
            };
            assert!(text() == text());
        }
    }
}
