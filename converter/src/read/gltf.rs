//! glTF 2.0, with its data in the file (GLB), beside it or within the text.
//!
//! The default scene is read: all triangles, strips and fans of its meshes, at the places of their nodes. Skins, morph
//! targets and animations are left as they stand in the file.

mod accessor;
mod document;
mod material;
mod resource;
mod transform;

use super::weld::weld_vertices;
use crate::mesh::NO_NORMAL;
use crate::{ConvertError, Mesh};
use ::gltf::mesh::{Mode, Semantic};
use ::gltf::{Document, Node, Primitive};
use accessor::Accessors;
use material::{Materials, displayed};
use resource::Resources;
use std::collections::BTreeSet;
use std::path::Path;
use transform::Transform;

/// Reads the bytes of a glTF or GLB file; `path` is where it is from.
pub(super) fn read(path: &Path, bytes: &[u8]) -> Result<Mesh, ConvertError> {
    let wrong = |problem| ConvertError::Model { path: path.to_owned(), problem };
    let (document, blob) = document::parse(bytes).map_err(&wrong)?;
    let resources = Resources::load(path, &document, blob).map_err(&wrong)?;
    let mut reader = Reader {
        accessors: Accessors::new(&resources),
        materials: Materials::new(&document, &resources),
        mesh: Mesh::default(),
        skipped: BTreeSet::new(),
        visited: vec![false; document.nodes().len()],
        has_normals: false,
        has_colors: false,
        has_texture_coordinates: false,
    };
    reader.scene(&document).map_err(&wrong)?;
    let mut mesh = reader.finish();
    mesh.check()?;
    weld_vertices(&mut mesh)?;
    Ok(mesh)
}

struct Reader<'a> {
    accessors: Accessors<'a>,
    materials: Materials<'a>,
    mesh: Mesh,
    /// What has been left out.
    skipped: BTreeSet<String>,
    /// Nodes that have been read: one that comes twice would be its own descendant, or have two parents.
    visited: Vec<bool>,
    has_normals: bool,
    has_colors: bool,
    has_texture_coordinates: bool,
}

impl<'a> Reader<'a> {
    fn scene(&mut self, document: &'a Document) -> Result<(), String> {
        // Depth first, on a stack of its own: files may nest deeper than the program's stack.
        let mut stack: Vec<(Node<'a>, Transform)> = Vec::new();
        match document.default_scene().or_else(|| document.scenes().next()) {
            Some(scene) => stack.extend(scene.nodes().map(|node| (node, Transform::IDENTITY))),
            None => {
                let children: BTreeSet<usize> =
                    document.nodes().flat_map(|node| node.children()).map(|child| child.index()).collect();
                let roots = document.nodes().filter(|node| !children.contains(&node.index()));
                stack.extend(roots.map(|node| (node, Transform::IDENTITY)));
            }
        }
        stack.reverse();
        while let Some((node, parent)) = stack.pop() {
            if std::mem::replace(&mut self.visited[node.index()], true) {
                return Err(format!("node {} has two parents; correct the tree of nodes", node.index()));
            }
            let transform = parent.then(&node.transform());
            if node.skin().is_some() {
                self.skipped.insert("skins are left out: the model stands as it was modelled".to_owned());
            }
            if let Some(mesh) = node.mesh() {
                for primitive in mesh.primitives() {
                    self.primitive(&primitive, &transform).map_err(|error| {
                        format!("mesh {}, primitive {}: {error}", mesh.index(), primitive.index())
                    })?;
                }
            }
            let children: Vec<Node<'a>> = node.children().collect();
            stack.extend(children.into_iter().rev().map(|child| (child, transform)));
        }
        Ok(())
    }

    fn primitive(&mut self, primitive: &Primitive<'a>, transform: &Transform) -> Result<(), String> {
        let mode = primitive.mode();
        if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
            self.skipped.insert("points and lines have no surface and are left out".to_owned());
            return Ok(());
        }
        if primitive.morph_targets().next().is_some() {
            self.skipped.insert("morph targets are left out".to_owned());
        }
        let Some(positions) = primitive.get(&Semantic::Positions) else {
            self.skipped.insert("primitives without positions are left out".to_owned());
            return Ok(());
        };
        let positions = self.accessors.read::<3>(&positions)?;
        let count = positions.len();
        let indices = match primitive.indices() {
            Some(accessor) => self.accessors.read_indices(&accessor, count)?,
            None => {
                (0..u32::try_from(count).map_err(|_| format!("{count} vertices are too many"))?).collect()
            }
        };
        let material = self.materials.index(&primitive.material());
        let set = self.materials.texture_set(material);

        // What corners have beside positions: one for each vertex, or nothing.
        let attribute = |name| match primitive.get(&name) {
            Some(accessor) => self.accessors.read_for_vertices::<3>(&accessor, count).map(Some),
            None => Ok(None),
        };
        let normals = attribute(Semantic::Normals)?;
        let colors = attribute(Semantic::Colors(0))?;
        let texture_coordinates = match primitive.get(&Semantic::TexCoords(set)) {
            Some(accessor) => Some(self.accessors.read_for_vertices::<2>(&accessor, count)?),
            None => None,
        };
        self.has_normals |= normals.is_some();
        self.has_colors |= colors.is_some();
        self.has_texture_coordinates |= texture_coordinates.is_some();

        let first = self.mesh.positions.len();
        let total = self.mesh.triangles.len() + indices.len();
        if first + count > u32::MAX as usize / 3 || total > u32::MAX as usize / 3 {
            return Err("the scene has too many vertices; split it".to_owned());
        }
        self.mesh.positions.extend(positions.iter().map(|position| transform.point(*position)));
        for corners in triangles(mode, &indices) {
            // Seen in a mirror a triangle turns the other way.
            let [a, b, c] = corners;
            let corners = if transform.mirrors() { [a, c, b] } else { [a, b, c] };
            let mesh = &mut self.mesh;
            mesh.triangles.push(corners.map(|corner| first as u32 + corner));
            mesh.triangle_materials.push(material);
            mesh.corner_normals.push(corners.map(|corner| match &normals {
                Some(normals) => transform.normal(normals[corner as usize]),
                None => NO_NORMAL,
            }));
            mesh.corner_colors.push(corners.map(|corner| match &colors {
                Some(colors) => displayed(colors[corner as usize]).map(|channel| channel as f32),
                None => [1.0; 3],
            }));
            mesh.corner_texture_coordinates.push(corners.map(|corner| match &texture_coordinates {
                Some(coordinates) => {
                    let [u, v] = coordinates[corner as usize];
                    // Down in the file, up in the mesh.
                    [u as f32, (1.0 - v) as f32]
                }
                None => [0.0; 2],
            }));
        }
        Ok(())
    }

    fn finish(self) -> Mesh {
        let mut mesh = self.mesh;
        if !self.has_normals {
            mesh.corner_normals = Vec::new();
        }
        if !self.has_colors {
            mesh.corner_colors = Vec::new();
        }
        if !self.has_texture_coordinates {
            mesh.corner_texture_coordinates = Vec::new();
        }
        mesh.warnings.extend(self.skipped);
        let (materials, images, warnings) = self.materials.finish();
        mesh.materials = materials;
        mesh.images = images;
        mesh.warnings.extend(warnings);
        mesh
    }
}

/// The triangles of a list, a strip or a fan of corners. What is left over is no triangle.
fn triangles(mode: Mode, indices: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        Mode::TriangleStrip => {
            let turned = |(index, corners): (usize, &[u32])| match index % 2 {
                0 => [corners[0], corners[1], corners[2]],
                _ => [corners[0], corners[2], corners[1]],
            };
            indices.windows(3).enumerate().map(turned).collect()
        }
        Mode::TriangleFan => {
            indices.windows(2).skip(1).map(|corners| [corners[0], corners[1], indices[0]]).collect()
        }
        _ => indices.as_chunks::<3>().0.to_vec(),
    }
}

#[cfg(test)]
mod tests;
