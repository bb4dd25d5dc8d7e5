//! A growing polygon mesh with colours at its vertices and a material on each face.

use crate::color::{Color, WHITE};
use crate::normals;
use glam::{DAffine3, DVec2, DVec3};

/// A point of the surface. Faces that meet share it, whatever their normals and materials.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vertex {
    pub position: DVec3,
    pub color: Color,
}

impl From<DVec3> for Vertex {
    fn from(position: DVec3) -> Self {
        Self { position, color: WHITE }
    }
}

impl From<(DVec3, Color)> for Vertex {
    fn from((position, color): (DVec3, Color)) -> Self {
        Self { position, color }
    }
}

/// A corner of a face: indices into the mesh's lists.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Corner {
    pub vertex: usize,
    pub normal: Option<usize>,
    pub uv: Option<usize>,
}

/// A material's place in its scene's list.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub struct MaterialId(pub usize);

/// A convex polygon, counter-clockwise seen from outside.
#[derive(Debug, Clone)]
pub struct Face {
    pub corners: Vec<Corner>,
    pub material: MaterialId,
    /// The surface is smooth towards neighbours that are inclined by less than this, in turns.
    pub crease: f64,
}

/// The crease of a new face: keeps the edges of boxes sharp and balls round.
const DEFAULT_CREASE: f64 = 0.1;

/// Vertices, normals and texture coordinates, and the faces that combine them. Right-handed, y is up.
#[derive(Debug, Clone, Default)]
pub struct Mesh {
    pub vertices: Vec<Vertex>,
    pub normals: Vec<DVec3>,
    pub uvs: Vec<DVec2>,
    pub faces: Vec<Face>,
}

impl Mesh {
    /// Adds a vertex and returns its index.
    pub fn vertex(&mut self, vertex: impl Into<Vertex>) -> usize {
        self.vertices.push(vertex.into());
        self.vertices.len() - 1
    }

    /// Adds a face over the vertices of these indices, counter-clockwise seen from outside.
    pub fn face(&mut self, vertices: &[usize]) {
        let corners = vertices.iter().map(|&vertex| Corner { vertex, normal: None, uv: None }).collect();
        self.faces.push(Face { corners, material: MaterialId::default(), crease: DEFAULT_CREASE });
    }

    /// Adds triangles from the point `apex` to each edge of a closed ring of vertices.
    pub fn fan(&mut self, apex: impl Into<Vertex>, ring: &[usize]) {
        let apex = self.vertex(apex);
        for (index, &from) in ring.iter().enumerate() {
            self.face(&[apex, from, ring[(index + 1) % ring.len()]]);
        }
    }

    /// The number of triangles after cutting every face into a fan.
    pub fn triangle_count(&self) -> usize {
        self.faces.iter().map(|face| face.corners.len() - 2).sum()
    }

    /// The positions of a face's corners.
    pub fn outline<'a>(&'a self, face: &'a Face) -> impl Iterator<Item = DVec3> + Clone + 'a {
        face.corners.iter().map(|corner| self.vertices[corner.vertex].position)
    }

    /// The mean of a face's corners.
    pub fn center(&self, face: &Face) -> DVec3 {
        self.outline(face).sum::<DVec3>() / face.corners.len() as f64
    }

    /// This mesh, made of one material.
    #[must_use]
    pub fn of(self, material: MaterialId) -> Self {
        self.assigned(|_, _, _| material)
    }

    /// This mesh, with the material that `choose` returns for each face's index, centre and normal.
    #[must_use]
    pub fn assigned(mut self, choose: impl Fn(usize, DVec3, DVec3) -> MaterialId) -> Self {
        for index in 0..self.faces.len() {
            let face = &self.faces[index];
            let normal = normals::of_polygon(self.outline(face)).normalize_or_zero();
            self.faces[index].material = choose(index, self.center(face), normal);
        }
        self
    }

    /// This mesh, smooth all over.
    #[must_use]
    pub fn smooth(self) -> Self {
        self.creased(0.5)
    }

    /// This mesh, sharp where faces are inclined by `crease` turns or more.
    #[must_use]
    pub fn creased(mut self, crease: f64) -> Self {
        self.faces.iter_mut().for_each(|face| face.crease = crease);
        self
    }

    /// This mesh, coloured at each vertex by its position.
    #[must_use]
    pub fn painted(mut self, color: impl Fn(DVec3) -> Color) -> Self {
        for vertex in &mut self.vertices {
            vertex.color = color(vertex.position);
        }
        self
    }

    /// This mesh, with each vertex moved by `displace`. Drops the normals.
    #[must_use]
    pub fn displaced(mut self, displace: impl Fn(DVec3) -> DVec3) -> Self {
        for vertex in &mut self.vertices {
            vertex.position = displace(vertex.position);
        }
        self.normals.clear();
        for corner in self.faces.iter_mut().flat_map(|face| &mut face.corners) {
            corner.normal = None;
        }
        self
    }

    /// This mesh, put in its place by a map that does not mirror. Drops the normals.
    #[must_use]
    pub fn placed(self, placement: DAffine3) -> Self {
        self.displaced(|position| placement.transform_point3(position))
    }

    /// Adds another mesh, as a surface of its own.
    pub fn append(&mut self, other: Self) {
        let (vertices, normals, uvs) = (self.vertices.len(), self.normals.len(), self.uvs.len());
        self.vertices.extend(other.vertices);
        self.normals.extend(other.normals);
        self.uvs.extend(other.uvs);
        self.faces.extend(other.faces.into_iter().map(|mut face| {
            for corner in &mut face.corners {
                corner.vertex += vertices;
                corner.normal = corner.normal.map(|index| index + normals);
                corner.uv = corner.uv.map(|index| index + uvs);
            }
            face
        }));
    }
}

impl Extend<Mesh> for Mesh {
    fn extend<I: IntoIterator<Item = Mesh>>(&mut self, meshes: I) {
        meshes.into_iter().for_each(|mesh| self.append(mesh));
    }
}

impl FromIterator<Mesh> for Mesh {
    fn from_iter<I: IntoIterator<Item = Mesh>>(meshes: I) -> Self {
        let mut whole = Self::default();
        whole.extend(meshes);
        whole
    }
}
