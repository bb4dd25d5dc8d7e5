use super::*;
use crate::region::{check_within, parse_region};
use octvox_raytracer::Region;
use octvox_raytracer::{FirstHit, Frame, Light3};
use tempfile::TempDir;

const SIZE: [u32; 2] = [12, 9];

const REGIONS: [&str; 3] = ["0,0,12,4", "0,4,5,5", "5,4,7,5"];

/// A frame of which the pixels outside a region are transparent, as `render --region` writes it.
fn frame(region: &str) -> Frame {
    let region: Region = parse_region(region).unwrap();
    check_within(&region, SIZE).unwrap();
    let [width, height] = SIZE;
    let of_pixels = |of: &dyn Fn(u32) -> f32| -> Vec<f32> {
        let is_in = |at: u32| region.contains([at % width, at / width]);
        (0..width * height).map(|at| if is_in(at) { of(at) } else { f32::NEG_INFINITY }).collect()
    };
    let values = of_pixels(&|at| at as f32);
    let is_in = |value: f32| value >= 0.0;
    let pixel = |&value: &f32| if is_in(value) { [value as u8, 7, 0, 255] } else { [0; 4] };
    let light = |&value: &f32| if is_in(value) { Light3::new(value, 0.1, f32::NAN) } else { Light3::ZERO };
    let met = |&value: &f32| match is_in(value) {
        true => FirstHit { distance: value + 0.5, normal: [0.0, 1.0, -0.0], steps: 3, level: 9 },
        false => FirstHit::NONE,
    };
    Frame {
        width,
        height,
        pixels: values.iter().map(pixel).collect(),
        light: Some(values.iter().map(light).collect()),
        hit_pixels: 0,
        first_hits: Some(values.iter().map(met).collect()),
    }
}

struct Files {
    folder: TempDir,
    extension: &'static str,
}

impl Files {
    fn new(extension: &'static str) -> Self {
        Self { folder: tempfile::tempdir().unwrap(), extension }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name).with_extension(self.extension)
    }

    fn put(&self, name: &str, frame: &Frame) -> PathBuf {
        let path = self.path(name);
        crate::picture_file::write_frame(&path, frame).unwrap();
        path
    }

    fn merge(&self, parts: &[PathBuf], partial: bool) -> anyhow::Result<Vec<u8>> {
        let output = self.path("merged");
        let report = write_merged(&Arguments { parts: parts.to_vec(), output: output.clone(), partial })?;
        assert_eq!([report.width, report.height], SIZE);
        assert_eq!((report.pixels == 108, report.parts), (!partial, parts.len()));
        Ok(std::fs::read(output)?)
    }

    /// The error line without the folder, which must leave nothing behind.
    fn error(&self, parts: &[PathBuf]) -> String {
        let line = format!("{:#}", self.merge(parts, false).unwrap_err());
        assert!(!self.path("merged").exists());
        line.replace(&format!("{}/", self.folder.path().display()), "")
    }
}

#[test]
fn parts_become_the_whole_byte_for_byte() {
    for extension in ["png", "exr"] {
        let files = Files::new(extension);
        let whole = std::fs::read(files.put("whole", &frame("0,0,12,9"))).unwrap();
        let mut parts: Vec<_> = REGIONS.iter().map(|region| files.put(region, &frame(region))).collect();
        assert!(files.merge(&parts, false).unwrap() == whole, "{extension}");
        parts.reverse();
        assert!(files.merge(&parts, false).unwrap() == whole, "{extension}, in another order");
        // What two parts show alike is no matter.
        parts.push(files.put("more", &frame("3,2,8,4")));
        assert!(files.merge(&parts, false).unwrap() == whole, "{extension}, with an overlap");
        assert!(files.merge(&[files.path("whole")], false).unwrap() == whole, "{extension}, of one part");
    }
}

#[test]
fn missing_pixels_are_counted() {
    for extension in ["png", "exr"] {
        let files = Files::new(extension);
        let parts = [REGIONS[0], REGIONS[2]].map(|region| files.put(region, &frame(region)));
        assert_eq!(
            files.error(&parts),
            format!(
                "merged.{extension}: 25 of 108 pixels are shown by no part, the first at 0,4; \
                 add the parts that show them, or use --partial"
            )
        );
        let partial = files.merge(&parts, true).unwrap();
        // What is merged so far is a part of the whole.
        std::fs::write(files.path("partial"), partial).unwrap();
        let whole = std::fs::read(files.put("whole", &frame("0,0,12,9"))).unwrap();
        let rest = files.put(REGIONS[1], &frame(REGIONS[1]));
        assert!(files.merge(&[files.path("partial"), rest], false).unwrap() == whole, "{extension}");
    }
}

#[test]
fn sizes_must_be_equal() {
    let files = Files::new("png");
    let part = files.put("part", &frame(REGIONS[0]));
    let small = Frame { height: 4, pixels: vec![[255; 4]; 48], ..frame(REGIONS[0]) };
    assert_eq!(
        files.error(&[part, files.put("small", &small)]),
        "part.png is 12x9, small.png is 12x4; each part is as large as the whole picture"
    );
}

#[test]
fn what_two_parts_show_must_be_equal() {
    let different = |message: &str, extension: &'static str, change: &dyn Fn(&mut Frame)| {
        let files = Files::new(extension);
        let mut changed = frame("0,3,12,6");
        change(&mut changed);
        let empty = files.put("empty", &frame("11,8,1,1"));
        let parts = [empty, files.put("upper", &frame("0,0,12,4")), files.put("lower", &changed)];
        assert_eq!(files.error(&parts), message);
    };
    let at = 3 * 12 + 2;
    let rest = "both show the pixel at 2,3 and differ; render both again with the same settings";
    different(&format!("upper.png and lower.png {rest}"), "png", &|frame| frame.pixels[at][1] += 1);
    different(&format!("upper.exr and lower.exr {rest}"), "exr", &|frame| {
        frame.first_hits.as_mut().unwrap()[at].steps += 1;
    });
}

#[test]
fn channels_must_be_equal() {
    let files = Files::new("exr");
    let upper = files.put("upper", &frame("0,0,12,4"));
    let lower = files.put("lower", &Frame { first_hits: None, ..frame("0,4,12,5") });
    assert_eq!(
        files.error(&[upper, lower]),
        "upper.exr has the channels A, B, G, R, depth.Z, level, normal.X, normal.Y, normal.Z, steps, \
         lower.exr has A, B, G, R; render both again with the same settings"
    );
}

#[test]
fn a_part_tells_what_it_shows() {
    let files = Files::new("exr");
    let path = files.path("part");
    let channel = Channel { name: "Y".to_owned(), samples: vec![1.0; 6] };
    Picture { size: [2, 3], content: Content::Channels(vec![channel]) }.write(&path).unwrap();
    assert_eq!(files.error(&[path]), "part.exr: there is no channel A, which tells what it shows");
}

#[test]
fn kinds_must_be_equal() {
    let files = Files::new("png");
    let exr = files.path("part").with_extension("exr");
    assert_eq!(
        files.error(&[exr]),
        "part.exr cannot become part of merged.png; PNG files make a PNG file, OpenEXR files an OpenEXR file"
    );
    let other = files.path("part").with_extension("jpg");
    assert!(files.error(&[other]).starts_with("part.jpg: pictures are PNG or OpenEXR files"));
    assert!(files.error(&[files.path("absent")]).starts_with("absent.png: cannot read the picture: "));
}
