//! Wavefront OBJ and MTL files into a mesh.

use crate::ConvertError;
use crate::Material;
use crate::mesh::{Mesh, NO_NORMAL};
use crate::mtl::load_materials;
use crate::obj_text::{ObjText, VertexColors, WITH_NORMALS, first_bad_number};
use crate::triangulation::Triangulation;
use std::cell::RefCell;
use std::collections::{BTreeSet, HashMap};
use std::path::Path;

/// Everything as it stands in the file: polygons, an index for each of position and normal.
const LOAD_OPTIONS: tobj::LoadOptions =
    tobj::LoadOptions { single_index: false, triangulate: false, ignore_points: true, ignore_lines: true };

/// Reads an OBJ file and the MTL files it names.
///
/// Polygons are cut into triangles. Vertices at the same place become one, so that a surface stays connected across
/// groups and materials. Texture coordinates, curves, smoothing groups and names are not kept. A missing material or
/// MTL file is noted in [`Mesh::warnings`]; its triangles are grey.
///
/// # Errors
/// [`ConvertError::Read`] if the file cannot be read, [`ConvertError::Statement`] and [`ConvertError::FaceIndex`] with
/// the line of what is wrong in it, [`ConvertError::NoFaces`] if it has no surface.
pub fn load_mesh(path: &Path) -> Result<Mesh, ConvertError> {
    let read_error = |source| ConvertError::Read { path: path.to_owned(), source };
    let bytes = std::fs::read(path).map_err(read_error)?;
    match parse(path, &bytes, VertexColors::AsWritten)? {
        Some(mesh) => Ok(mesh),
        // Cannot ask twice: completed colours are never mixed.
        None => parse(path, &bytes, VertexColors::Completed)?.ok_or(ConvertError::NoFaces),
    }
}

/// `None` if the vertex colours must be completed first.
fn parse(path: &Path, bytes: &[u8], colors: VertexColors) -> Result<Option<Mesh>, ConvertError> {
    let warnings = RefCell::new(Vec::new());
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut text = ObjText::new(path, bytes, colors);
    let loaded = tobj::load_obj_buf(&mut text, &LOAD_OPTIONS, |library| {
        load_materials(folder, library, &mut warnings.borrow_mut())
    });
    if colors == VertexColors::AsWritten && text.has_mixed_colors() {
        return Ok(None);
    }
    let (models, materials) = match loaded {
        Ok((models, materials)) => (models, materials.unwrap_or_default()),
        Err(source) => return Err(text.into_error().unwrap_or_else(|| parser_error(path, bytes, source))),
    };

    let mut warnings = warnings.into_inner();
    let defined: BTreeSet<&String> = materials.iter().map(|material| &material.name).collect();
    let undefined = text.used_materials().iter().filter(|name| !defined.contains(name));
    warnings.extend(undefined.map(|name| format!("material {name} is not defined: its triangles are grey")));
    if text.lines_and_points() > 0 {
        warnings
            .push(format!("{} lines or points have no surface and are left out", text.lines_and_points()));
    }
    let mut builder = MeshBuilder::new(&materials);
    for model in models {
        builder.add(&model)?;
    }
    let mesh = builder.finish(warnings);
    match mesh.check() {
        Err(ConvertError::NotFinite { .. }) => {
            Err(parser_error(path, bytes, tobj::LoadError::PositionParseError))
        }
        Err(ConvertError::NoFaces) => Err(ConvertError::Model {
            path: path.to_owned(),
            problem: "no faces; export the model with its surface (`f` lines)".to_owned(),
        }),
        Err(error) => Err(error),
        Ok(()) => Ok(Some(mesh)),
    }
}

/// What the parser objects to, with the line if it is a number.
fn parser_error(path: &Path, bytes: &[u8], source: tobj::LoadError) -> ConvertError {
    let path = path.to_owned();
    match first_bad_number(bytes) {
        Some((line, problem)) => ConvertError::Statement { path, line, problem },
        None => ConvertError::Model { path, problem: format!("no valid OBJ file: {source}") },
    }
}

/// Joins the models of the parser, each with its own indices, into one mesh.
struct MeshBuilder {
    mesh: Mesh,
    /// Vertices by the bits of their coordinates.
    places: HashMap<[u64; 3], u32>,
    triangulation: Triangulation,
    /// The material of faces that have none.
    without_material: Option<u32>,
}

impl MeshBuilder {
    fn new(materials: &[tobj::Material]) -> Self {
        let mut mesh = Mesh::default();
        mesh.materials.extend(materials.iter().map(|material| {
            Material::matte(&material.name, material.diffuse.unwrap_or(Material::DEFAULT_DIFFUSE))
        }));
        Self { mesh, places: HashMap::new(), triangulation: Triangulation::default(), without_material: None }
    }

    fn add(&mut self, model: &tobj::Model) -> Result<(), ConvertError> {
        let source = &model.mesh;
        let has_normals = model.name == WITH_NORMALS && source.normal_indices.len() == source.indices.len();
        let has_colors = source.vertex_color.len() == source.positions.len();
        let material = self.material(source.material_id, has_colors);
        self.places.reserve(source.positions.len() / 3);
        let vertices = source
            .positions
            .as_chunks::<3>()
            .0
            .iter()
            .map(|&position| self.vertex(position))
            .collect::<Result<Vec<u32>, _>>()?;
        let normals = source.normals.as_chunks::<3>().0;
        let colors = source.vertex_color.as_chunks::<3>().0;

        let mut polygon = Vec::new();
        let mut first = 0;
        let arities = source.face_arities.iter().map(|&arity| arity as usize);
        let triangles = if source.face_arities.is_empty() { source.indices.len() / 3 } else { 0 };
        let mesh = &mut self.mesh;
        for corners in arities.chain(std::iter::repeat_n(3, triangles)) {
            let face = &source.indices[first..first + corners];
            polygon.clear();
            polygon.extend(face.iter().map(|&index| mesh.positions[vertices[index as usize] as usize]));
            self.triangulation.cut(&polygon, |triangle| {
                mesh.triangles.push(triangle.map(|corner| vertices[face[corner] as usize]));
                mesh.triangle_materials.push(material);
                mesh.corner_normals.push(triangle.map(|corner| {
                    if has_normals {
                        normals[source.normal_indices[first + corner] as usize].map(|n| n as f32)
                    } else {
                        NO_NORMAL
                    }
                }));
                if has_colors {
                    mesh.corner_colors
                        .push(triangle.map(|corner| colors[face[corner] as usize].map(|c| c as f32)));
                }
            });
            first += corners;
        }
        Ok(())
    }

    /// Index of the material, adding one for faces that have none. Either all vertices have a colour or none has.
    fn material(&mut self, id: Option<usize>, has_colors: bool) -> u32 {
        let materials = &mut self.mesh.materials;
        if let Some(id) = id.filter(|&id| id < materials.len()) {
            return id as u32;
        }
        *self.without_material.get_or_insert_with(|| {
            // Vertex colours alone show as they are.
            let diffuse = if has_colors { [1.0; 3] } else { Material::DEFAULT_DIFFUSE };
            materials.push(Material::matte("", diffuse));
            materials.len() as u32 - 1
        })
    }

    /// Index of the vertex at a position, the same for the same position.
    fn vertex(&mut self, position: [f64; 3]) -> Result<u32, ConvertError> {
        // Adding zero turns -0.0 into 0.0.
        let position = position.map(|coordinate| coordinate + 0.0);
        let count = self.mesh.positions.len();
        let max = u32::MAX as usize / 3;
        if count >= max {
            return Err(ConvertError::TooLarge { kind: "vertices", count, max });
        }
        let vertex = *self.places.entry(position.map(f64::to_bits)).or_insert(count as u32);
        if vertex as usize == count {
            self.mesh.positions.push(position);
        }
        Ok(vertex)
    }

    fn finish(self, warnings: Vec<String>) -> Mesh {
        let mut mesh = self.mesh;
        mesh.warnings = warnings;
        if mesh.corner_normals.iter().all(|normals| *normals == [NO_NORMAL; 3]) {
            mesh.corner_normals = Vec::new();
        }
        mesh
    }
}
