//! The camera on the command line.

use crate::model::Model;
use anyhow::{bail, ensure};
use glam::DVec3;
use octvox_format::WorldTransform;
use octvox_raytracer::{Camera, DEFAULT_FOV, MAX_PIXELS, Octree};

/// Where the eye is and how large the picture.
#[derive(clap::Args)]
pub struct CameraArguments {
    /// Columns and rows of the picture [default: 1312x640]
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    pub size: Option<[u32; 2]>,
    /// Position of the eye [default: the whole model is in the picture]
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_point, allow_hyphen_values = true)]
    eye: Option<DVec3>,
    /// The point in the middle of the picture [default: the middle of the model]
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_point, allow_hyphen_values = true)]
    target: Option<DVec3>,
    /// A direction that is upwards in the picture [default: 0,1,0]
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_point, allow_hyphen_values = true)]
    up: Option<DVec3>,
    /// Angle between the lower and the upper edge of the picture, in degrees [default: 43.6028]
    #[arg(long, value_name = "DEGREES")]
    fov: Option<f64>,
    /// What coordinates mean: the model's cube as [0, 1]³, or the world that the mesh came from
    #[arg(long, value_enum, default_value_t = Space::Unit)]
    space: Space,
}

#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Space {
    Unit,
    World,
}

fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let parts: Option<(&str, &str)> = text.split_once(['x', 'X']);
    let size = parts.and_then(|(width, height)| Some([width.parse().ok()?, height.parse().ok()?]));
    match size {
        Some([0, _] | [_, 0]) | None => Err("expected two numbers above zero such as 1312x640".into()),
        Some([width, height]) if u64::from(width) * u64::from(height) > MAX_PIXELS => {
            Err(format!("more than {MAX_PIXELS} pixels"))
        }
        Some(size) => Ok(size),
    }
}

fn parse_point(text: &str) -> Result<DVec3, String> {
    let parts: Vec<f64> = text.split(',').filter_map(|part| part.trim().parse().ok()).collect();
    match parts[..] {
        [x, y, z] if text.split(',').count() == 3 && [x, y, z].iter().all(|part| part.is_finite()) => {
            Ok(DVec3::new(x, y, z))
        }
        _ => Err("expected three finite numbers such as 0.5,0.5,1.9".into()),
    }
}

impl CameraArguments {
    /// Columns and rows of the picture if nobody says otherwise.
    pub const DEFAULT_SIZE: [u32; 2] = [1312, 640];

    /// Columns and rows of the picture.
    pub fn size(&self) -> [u32; 2] {
        self.size.unwrap_or(Self::DEFAULT_SIZE)
    }

    /// Whether coordinates are said to be those of the world.
    fn is_in_world(&self) -> bool {
        self.space == Space::World
    }

    /// A scene's camera, but for what is given here. Coordinates are those of the scene.
    pub fn of_scene(&self, camera: Camera) -> anyhow::Result<Camera> {
        ensure!(!self.is_in_world(), "--space is for a model alone; a scene has coordinates of its own");
        Ok(self.changed(camera))
    }

    fn changed(&self, camera: Camera) -> Camera {
        Camera {
            eye: self.eye.unwrap_or(camera.eye),
            target: self.target.unwrap_or(camera.target),
            up: self.up.unwrap_or(camera.up),
            vertical_fov: self.fov.unwrap_or(camera.vertical_fov),
        }
    }

    /// The camera of a picture of a model.
    pub fn camera(&self, model: &Model) -> anyhow::Result<Camera> {
        self.of_model(&model.octree, model.world.as_ref(), self.size())
    }

    /// The same for a picture of so many columns and rows: all of the model is in it, but for what is given here. Coordinates may
    /// be those of the world in which the model's cube is.
    pub fn of_model(
        &self,
        octree: &Octree,
        world: Option<&WorldTransform>,
        [width, height]: [u32; 2],
    ) -> anyhow::Result<Camera> {
        let fov = self.fov.unwrap_or(DEFAULT_FOV);
        let framing = Camera::framing(octree, f64::from(width) / f64::from(height), fov);
        let to_unit = |point: DVec3| match (self.space, world) {
            (Space::Unit, _) => Ok(point),
            (Space::World, Some(world)) => {
                Ok(DVec3::from_array(world.to_cells(point.to_array())) / f64::from(octree.resolution()))
            }
            (Space::World, None) => {
                bail!("the file does not say where the model is in the world; use --space unit")
            }
        };
        let eye = self.eye.map(to_unit).transpose()?;
        let target = self.target.map(to_unit).transpose()?;
        let camera = self.changed(framing);
        Ok(Camera { eye: eye.unwrap_or(camera.eye), target: target.unwrap_or(camera.target), ..camera })
    }

    /// These arguments as they were given, but for the size: each with a blank before it.
    pub fn without_size(&self) -> String {
        let points = [("eye", self.eye), ("target", self.target), ("up", self.up)];
        let mut text = String::new();
        for (name, point) in points {
            if let Some(DVec3 { x, y, z }) = point {
                text += &format!(" --{name}={x},{y},{z}");
            }
        }
        if let Some(fov) = self.fov {
            text += &format!(" --fov {fov}");
        }
        if self.is_in_world() {
            text += " --space world";
        }
        text
    }
}
