//! How much of a normal 16 bits keep.

use super::super::record::{Chapter, Errors, Table};
use octvox_format::NormalCode;

/// Directions that are asked: evenly spread on the sphere.
const DIRECTIONS: u32 = 200_000;

/// The errors of each code over the whole sphere, and those of the truth's picture if its normals are kept in it.
pub fn normal_codes(pictures: &[(NormalCode, Errors)]) -> Chapter {
    let row = |name: &str, bits: u32, code: &dyn Fn([f32; 3]) -> [f32; 3]| {
        let (mut sum, mut largest) = (0.0, 0.0f64);
        for number in 0..DIRECTIONS {
            let direction = direction(number);
            let degrees = angle(direction, code(direction.map(|part| part as f32)));
            sum += degrees;
            largest = largest.max(degrees);
        }
        let mean = sum / f64::from(DIRECTIONS);
        vec![name.to_owned(), bits.to_string(), format!("{mean:.5}"), format!("{largest:.5}")]
    };
    let coded = |code: NormalCode| move |normal: [f32; 3]| code.decode(code.encode(normal));
    let table = Table {
        title: "Normal codes".into(),
        note: format!("Over {DIRECTIONS} directions, spread evenly on the sphere."),
        columns: ["code", "bits", "mean error (degrees)", "largest error (degrees)"]
            .map(String::from)
            .to_vec(),
        rows: vec![
            row("two angles of 8 bits (version 4)", 16, &coded(NormalCode::Spherical)),
            row("octahedron (version 5)", 16, &coded(NormalCode::Octahedral)),
            row("floating point, single precision", 96, &|normal| normal),
        ],
    };
    let introduction = "What the code of a normal alone loses. Voxels also lose what the mean over their cell does, which is \
                        more on curved surfaces: compare the errors of normals above.";
    let mut tables = vec![table];
    if !pictures.is_empty() {
        tables.push(of_pictures(pictures));
    }
    Chapter { title: "Normal codes".into(), introduction: introduction.into(), tables }
}

/// What codes alone do to a picture.
fn of_pictures(pictures: &[(NormalCode, Errors)]) -> Table {
    let mut rows: Vec<Vec<String>> = pictures
        .iter()
        .map(|(code, errors)| {
            let figures = [errors.normal_degrees, errors.color, errors.flip, errors.ssim];
            let cells = figures.map(|figure| format!("{figure:.5}"));
            [format!("{} (16 bits)", code.name())].into_iter().chain(cells).collect()
        })
        .collect();
    rows.push(["floating point (the truth itself)", "0", "0", "0", "1"].map(String::from).to_vec());
    Table {
        title: "The picture of the truth with normals in each code".into(),
        note: "The triangles seen by the tracer that finds the truth, with the normal of every hit kept in the code and \
               taken out again; there are no voxels, so all that differs is the code."
            .into(),
        columns: ["code", "normals (degrees)", "colour (of 255)", "FLIP", "SSIM"].map(String::from).to_vec(),
        rows,
    }
}

/// Points on a spiral from pole to pole, turned by the golden angle each (R. Swinbank, R. J. Purser, "Fibonacci grids: a
/// novel approach to global modelling", 2006).
fn direction(number: u32) -> [f64; 3] {
    let z = 1.0 - (2.0 * f64::from(number) + 1.0) / f64::from(DIRECTIONS);
    let turn = std::f64::consts::PI * (3.0 - 5f64.sqrt()) * f64::from(number);
    let radius = (1.0 - z * z).sqrt();
    [radius * turn.cos(), radius * turn.sin(), z]
}

/// The angle between two directions, in degrees; of small angles as exact as of large ones.
fn angle(a: [f64; 3], b: [f32; 3]) -> f64 {
    let (a, b) = (glam::DVec3::from_array(a), glam::DVec3::from_array(b.map(f64::from)));
    a.cross(b).length().atan2(a.dot(b)).to_degrees()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The bounds that the format promises.
    #[test]
    fn errors_are_within_those_of_the_format() {
        let chapter = normal_codes(&[]);
        let largest = |row: usize| chapter.tables[0].rows[row][3].parse::<f64>().unwrap();
        assert!((0.5..0.80).contains(&largest(0)) && (0.3..0.65).contains(&largest(1)), "{chapter:?}");
        assert!(largest(2) < 1e-5);
    }
}
