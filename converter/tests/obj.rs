//! Reading OBJ and MTL files.

mod support;

use octvox_converter::{ConvertError, Mesh, Options, load_mesh};
use std::collections::BTreeSet;
use std::path::PathBuf;
use support::voxels;

/// A folder with a model and perhaps its materials.
struct Model {
    folder: tempfile::TempDir,
}

impl Model {
    fn new(obj: impl AsRef<[u8]>) -> Self {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("model.obj"), obj).unwrap();
        Self { folder }
    }

    fn with(self, name: &str, text: &str) -> Self {
        std::fs::write(self.folder.path().join(name), text).unwrap();
        self
    }

    fn path(&self) -> PathBuf {
        self.folder.path().join("model.obj")
    }

    fn load(&self) -> Result<Mesh, ConvertError> {
        load_mesh(&self.path())
    }

    fn mesh(&self) -> Mesh {
        self.load().unwrap()
    }

    /// The colours of its voxels.
    fn colors(&self) -> BTreeSet<[u8; 3]> {
        voxels(&self.mesh(), &Options { depth: 4, ..Options::default() })
            .into_values()
            .map(|(color, _)| color)
            .collect()
    }

    /// The error, without the name of the folder.
    fn error(&self) -> String {
        let error = self.load().unwrap_err().to_string();
        error.strip_prefix(&format!("{}/", self.folder.path().display())).unwrap_or(&error).to_owned()
    }
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

fn square(faces: &str) -> Model {
    Model::new(format!("{SQUARE}{faces}"))
}

/// Corners of the triangles as positions, in a canonical order of triangles.
fn triangles(mesh: &Mesh) -> Vec<[[f64; 3]; 3]> {
    let mut triangles: Vec<_> = mesh
        .triangles()
        .iter()
        .map(|triangle| triangle.map(|vertex| mesh.positions()[vertex as usize]))
        .collect();
    triangles.sort_by(|a, b| a.partial_cmp(b).unwrap());
    triangles
}

#[test]
fn every_way_to_write_a_face_gives_the_same_mesh() {
    let expected = triangles(&square("f 1 2 3\nf 1 3 4\n").mesh());
    assert_eq!(expected.len(), 2);
    let normals_and_texture = "vt 0 0\nvt 1 1\nvn 0 0 1\n";
    for faces in [
        "f 1 2 3 4\n".to_owned(),
        "f -4 -3 -2 -1\n".to_owned(),
        "f 1 2 3\r\nf 1 3 4\r\n".to_owned(),
        "  f\t1  2 3   4  # a square\n".to_owned(),
        "f 1 2 \\\n 3 4\n".to_owned(),
        "f 1 2 \\\r\n 3 4".to_owned(),
        format!("{normals_and_texture}f 1//1 2//1 3//1 4//1\n"),
        format!("{normals_and_texture}f 1/1/1 2/2/1 3/1/1 4/2/-1\n"),
        format!("{normals_and_texture}f 1/1 2/2 3/1 4/2\n"),
        format!("{normals_and_texture}f 1// 2/ 3/1 4/2/1\n"),
        "g one\nf 1 2 3\no two\nusemtl none\ng three\ns 1\nf 1 3 4\n".to_owned(),
        "l 1 2 3\np 1\nf 1 2 3 4\nl 1 2\n".to_owned(),
    ] {
        assert_eq!(triangles(&square(&faces).mesh()), expected, "{faces:?}");
    }
    // Line ends of another kind in the vertices too.
    let carriage = Model::new(format!("{SQUARE}f 1 2 3 4\n").replace('\n', "\r\n"));
    assert_eq!(triangles(&carriage.mesh()), expected);
}

#[test]
fn a_concave_face_does_not_cover_its_dent() {
    let model = Model::new("v 0 0 0\nv 4 0 0\nv 4 4 0\nv 2 1 0\nf 1 2 3 4\n");
    let area: f64 = triangles(&model.mesh())
        .iter()
        .map(|[a, b, c]| ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs() / 2.0)
        .sum();
    assert_eq!(area, 6.0);
}

#[test]
fn vertices_are_shared_across_groups_and_materials() {
    let mesh = square("usemtl a\nf 1 2 3\ng other\nusemtl b\nf 1 3 4\n").mesh();
    assert_eq!(mesh.positions().len(), 4);
    // The same place written twice is one vertex as well.
    let mesh = square("v 0.0 -0 0\nv 1 1 0\nf 1 2 3\nf 5 6 4\n").mesh();
    assert_eq!(mesh.positions().len(), 4);
}

#[test]
fn normals_belong_to_the_faces_that_name_them() {
    // One triangle with normals along x, one without, one with again: the middle one gets its own, along z.
    let model = Model::new(
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 3 0 0\nv 4 0 0\nv 4 1 0\nv 6 0 0\nv 7 0 0\nv 7 1 0\nvn 1 0 0\n\
         f 1//1 2//1 3//1\nf 4 5 6\nf 7//1 8//1 9//1\n",
    );
    for (cell, (_, normal)) in voxels(&model.mesh(), &Options { depth: 5, ..Options::default() }) {
        let expected = if (11..21).contains(&cell[0]) { [0.0, 0.0, 1.0] } else { [1.0, 0.0, 0.0] };
        let decoded = normal.decode();
        assert!((0..3).all(|axis| (decoded[axis] - expected[axis]).abs() < 0.03), "{cell:?} {decoded:?}");
    }
}

#[test]
fn materials_color_their_faces() {
    let mtl = "# colours\nnewmtl red\nKd 1 0 0\nNs 10\n\nnewmtl a b\n\tKd 0.5 0.25 2.0 # too bright\nnewmtl grey\nKd 0.2\n";
    let obj = "mtllib my colors.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 0 0\nv 6 0 0\nv 5 1 0\nv 9 0 0\nv 10 0 0\nv 9 1 0\n\
               usemtl red\nf 1 2 3\nusemtl a b\nf 4 5 6\nusemtl\tgrey\nf 7 8 9\n";
    let model = Model::new(obj).with("my colors.mtl", mtl);
    assert_eq!(model.colors(), BTreeSet::from([[255, 0, 0], [128, 64, 255], [51; 3]]));
    assert_eq!(model.mesh().warnings(), [""; 0]);

    // The same from two files named in one statement.
    let (first, second) = mtl.split_at(mtl.find("newmtl a").unwrap());
    let model =
        Model::new(obj.replace("my colors.mtl", "1.mtl 2.mtl")).with("1.mtl", first).with("2.mtl", second);
    assert_eq!(model.colors(), BTreeSet::from([[255, 0, 0], [128, 64, 255], [51; 3]]));
}

#[test]
fn the_mark_before_utf_8_is_no_part_of_a_file() {
    let mtl = "\u{FEFF}newmtl red\nKd 1 0 0\n";
    let obj = "\u{FEFF}v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 5 5\nmtllib colors.mtl\nusemtl red\nf 1 2 3\n";
    let model = Model::new(obj).with("colors.mtl", mtl);
    assert_eq!(triangles(&model.mesh()), [[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]]);
    assert_eq!(model.colors(), BTreeSet::from([[255, 0, 0]]));
}

#[test]
fn missing_and_broken_materials_are_warnings() {
    let model = square("mtllib lost.mtl\nusemtl gone\nf 1 2 3 4\n");
    assert_eq!(model.colors(), BTreeSet::from([[204; 3]]));
    let mesh = model.mesh();
    let warnings = mesh.warnings();
    assert!(warnings[0].contains("lost.mtl: cannot read the materials"), "{warnings:?}");
    assert!(warnings[1].contains("material gone is not defined"), "{warnings:?}");

    let broken = "newmtl a\nKd 0.5\nnewmtl b\nKd spectral file.rfl 1\nnewmtl c\nKd 1 2\nnewmtl d\nKd nan 0 0\nNs x\nillum\nmap_Kd\nnewmtl\n";
    let model = square("mtllib m.mtl\nusemtl b\nf 1 2 3\nusemtl d\nf 1 3 4\nl 1 2\n").with("m.mtl", broken);
    assert_eq!(model.colors(), BTreeSet::from([[204; 3]]));
    let mesh = model.mesh();
    let warnings = mesh.warnings().join("\n");
    assert!(warnings.contains("m.mtl:4: `Kd spectral file.rfl 1` is no colour"), "{warnings}");
    assert!(warnings.contains("m.mtl:6:") && warnings.contains("m.mtl:8:"), "{warnings}");
    assert!(warnings.contains("1 lines or points"), "{warnings}");
}

#[test]
fn vertex_colors_are_shown() {
    let colored = |color: &str| {
        SQUARE.lines().map(|line| format!("{line} {color}\n")).collect::<String>() + "f 1 2 3 4\n"
    };
    assert_eq!(Model::new(colored("1 0.5 0")).colors(), BTreeSet::from([[255, 128, 0]]));
    // With opacity behind, and with a material's colour.
    assert_eq!(Model::new(colored("1 0.5 0 0.3")).colors(), BTreeSet::from([[255, 128, 0]]));
    let model = Model::new(format!("mtllib m.mtl\nusemtl m\n{}", colored("1 0.5 0")))
        .with("m.mtl", "newmtl m\nKd 0.2 1 1\n");
    assert_eq!(model.colors(), BTreeSet::from([[51, 128, 0]]));

    // Black to white: light is interpolated, and all colours are grey.
    let colors =
        Model::new("v 0 0 0 0 0 0\nv 1 0 0 1 1 1\nv 1 1 0 1 1 1\nv 0 1 0 0 0 0\nf 1 2 3 4\n").colors();
    assert_eq!(colors.len(), 16);
    assert!(colors.iter().all(|[red, green, blue]| red == green && green == blue));
}

#[test]
fn vertices_without_a_color_among_colored_ones_are_white() {
    let model = Model::new(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 0 0 1 0 0\nv 6 0 0 1 0 0\nv 5 1 0 1 0 0\nv 9 0 0 1\nv 10 0 0 1\nv 9 1 0 1\n\
         f 1 2 3\nf 4 5 6\nf 7 8 9\n",
    );
    assert_eq!(model.colors(), BTreeSet::from([[255; 3], [255, 0, 0]]));
}

#[test]
fn errors_name_file_line_and_reason() {
    for (faces, expected) in [
        (
            "f 1 2 5\n",
            "model.obj:5: the face refers to vertex 5, but 4 precede it; correct the index or add the missing lines",
        ),
        ("f 1 2 0\n", "model.obj:5: the face refers to vertex 0,"),
        ("\n\nf 1 2 -5\n", "model.obj:7: the face refers to vertex -5,"),
        ("f 1 2 3\nf 1 2 \\\n3 9\n", "model.obj:6: the face refers to vertex 9,"),
        ("f 1//1 2 3\n", "model.obj:5: the face refers to normal 1, but 0 precede it"),
        (
            "vn 0 0 1\nf 1//1 2//1 3//-9223372036854775808\n",
            "model.obj:6: the face refers to normal -9223372036854775808,",
        ),
        ("vt 0 0\nf 1/1 2/2 3/1\n", "model.obj:6: the face refers to texture coordinate 2, but 1 precede it"),
        (
            "f 1 2 99999999999999999999\n",
            "model.obj:5: `99999999999999999999` is no corner of a face; expected v, v/vt, v//vn or v/vt/vn",
        ),
        ("f 1 2 x\n", "model.obj:5: `x` is no corner"),
        ("f 1 2 /1\n", "model.obj:5: `/1` is no corner"),
        ("f 1/1/1/1 2 3\n", "model.obj:5: "),
        ("f 1 2\n", "model.obj:5: a face has 2 corners; expected at least 3"),
        ("v 1 2\nf 1 2 3\n", "model.obj:5: a vertex has 2 numbers;"),
        ("v 1 2 3 4 5\nf 1 2 3\n", "model.obj:5: a vertex has 5 numbers;"),
        ("vn 1 2\nf 1 2 3\n", "model.obj:5: a normal has 2 numbers; expected 3"),
        ("v 1 nan 2\nf 1 2 5\n", "model.obj:5: `nan` is no coordinate; expected a finite number"),
        ("v 1 1e999 2\nf 1 2 5\n", "model.obj:5: `1e999` is no coordinate"),
        ("v -inf 0 0 # far\nf 1 2 5\n", "model.obj:5: `-inf` is no coordinate"),
        ("v 1 2,5 0\nf 1 2 5\n", "model.obj:5: `2,5` is no number"),
        ("v 1 2 3 0 x 0\nf 1 2 3\n", "model.obj:5: `x` is no number"),
        ("v 1 2 3 0\nf 1 2 5\n", "model.obj:5: a vertex has the weight 0"),
        ("usemtl \nf 1 2 3\n", "model.obj:5: `usemtl` without the name of a material"),
        ("", "model.obj: the mesh has no faces; export it with its surface (`f` lines in OBJ)"),
        ("l 1 2 3\np 1\n", "model.obj: the mesh has no faces;"),
    ] {
        let error = square(faces).error();
        assert!(error.starts_with(expected), "{faces:?}: {error}");
    }
    assert!(Model::new("").error().starts_with("model.obj: the mesh has no faces"));
    let missing = load_mesh("no/such/model.obj".as_ref()).unwrap_err().to_string();
    assert!(missing.starts_with("no/such/model.obj: cannot read the model"), "{missing}");
}

#[test]
fn odd_but_harmless_files_are_read() {
    // A vertex that is no place but is not used, names that are not Unicode, other statements, a lone continuation.
    let model = Model::new(
        b"# \xff\xfe\nmtllib\nv nan 0 0\nv 0 0 0\nv 1 0 0 1.0\nv 0 1 0\nvp 1 2\ncurv 0 1\nusemtl \xe4\xf6\ng \xff\nf 2 3 4\n\\".as_slice(),
    );
    let mesh = model.mesh();
    assert_eq!(mesh.triangles().len(), 1);
    assert_eq!(model.colors(), BTreeSet::from([[204; 3]]));
}

#[test]
fn every_truncation_and_flipped_byte_is_an_error_or_a_mesh() {
    let obj = "mtllib m.mtl\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1e1 0 0 0 1\nv 0 1 -0.5 1 1 1\nvt 0 0\nvn 0 0 1\n\
               usemtl m\nf 1/1/1 2/1/1 -2/1/1 4/1/1\nf 1 2 3 \\\n4\n";
    let check = |bytes: &[u8]| {
        let model = Model::new(bytes).with("m.mtl", "newmtl m\nKd 1 0.5 0\n");
        if let Ok(mesh) = model.load() {
            // What is read can be converted, or does not fit, as a typed error.
            let _ = octvox_converter::convert(
                &mesh,
                &Options { depth: 2, ..Options::default() },
                &octvox_cli::Progress::hidden(),
                &mut Vec::new(),
            );
        }
    };
    for length in 0..obj.len() {
        check(&obj.as_bytes()[..length]);
    }
    for index in 0..obj.len() {
        for flip in [0x01, 0x04, 0x10, 0x20, 0x80] {
            let mut bytes = obj.as_bytes().to_vec();
            bytes[index] ^= flip;
            check(&bytes);
        }
    }
}
