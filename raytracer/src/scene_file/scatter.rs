//! `[[scatter]]`: many models at places that look random and are always the same.

use super::error::{SceneFileError, SceneProblem};
use super::instance::{Actor, Anchor, Pose};
use super::model::Models;
use super::text::Text;
use super::value::{Amount, NotNegative, Number, Positive};
use crate::random::Random;
use glam::{DQuat, DVec2, DVec3};
use serde::Deserialize;
use toml::Spanned;

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ScatterTable {
    model: Spanned<Names>,
    count: Spanned<Amount>,
    area: Spanned<[Number; 4]>,
    height: Option<Number>,
    scale: Option<Spanned<[Positive; 2]>>,
    turn: Option<bool>,
    seed: Option<u64>,
    distance: Option<NotNegative>,
}

/// One name or several.
#[derive(Debug, Clone, Deserialize)]
#[serde(untagged, expecting = "expected a model's name or a list of names")]
enum Names {
    One(String),
    Several(Vec<String>),
}

impl Names {
    fn list(&self) -> &[String] {
        match self {
            Self::One(name) => std::slice::from_ref(name),
            Self::Several(names) => names,
        }
    }
}

/// A rectangle of the ground, x and z.
#[derive(Debug, Clone, Copy)]
struct Area {
    low: DVec2,
    high: DVec2,
}

/// The models of one table. `number` is the seed of a table that gives none.
pub(super) fn scatter(
    text: &Text,
    models: &Models,
    number: u64,
    table: &ScatterTable,
) -> Result<Vec<Actor>, SceneFileError> {
    let span = table.model.span();
    let chosen = table.model.get_ref().list().iter().map(|name| models.find(text, name, &span));
    let chosen = chosen.collect::<Result<Vec<usize>, _>>()?;
    if chosen.is_empty() {
        return Err(text.error(&span, SceneProblem::EmptyName { key: "model" }));
    }
    let [xmin, zmin, xmax, zmax] = table.area.get_ref().map(|number| number.0);
    if xmin >= xmax || zmin >= zmax {
        return Err(text.error(&table.area.span(), SceneProblem::EmptyArea));
    }
    let area = Area { low: DVec2::new(xmin, zmin), high: DVec2::new(xmax, zmax) };
    let [least, most] = table.scale.as_ref().map_or([1.0; 2], |scale| scale.get_ref().map(|scale| scale.0));
    if let Some(scale) = table.scale.as_ref().filter(|_| least > most) {
        return Err(text.error(&scale.span(), SceneProblem::Order { what: "scale", low: least, high: most }));
    }
    let count = table.count.get_ref().0;
    let distance = table.distance.map_or(0.0, |distance| distance.0);
    let seed = table.seed.unwrap_or(number);
    let places = places(area, count, distance, &mut Random::stream(seed, 0));
    if places.len() < count as usize {
        let problem = SceneProblem::TooDense { count, placed: places.len() as u32, distance };
        return Err(text.error(&table.count.span(), problem));
    }
    let height = table.height.map_or(0.0, |height| height.0);
    let actors = (1..).zip(places).map(|(number, place)| {
        let random = &mut Random::stream(seed, number);
        let model = chosen[(part(random) * chosen.len() as f64) as usize];
        let scale = least + (most - least) * part(random);
        let angle = if table.turn.unwrap_or(true) { part(random) * std::f64::consts::TAU } else { 0.0 };
        let pose = Pose {
            position: DVec3::new(place.x, height, place.y),
            rotation: DQuat::from_rotation_y(angle),
            scale,
        };
        // All share the materials of the middle size: else each would need a palette of its own.
        Actor::still(model, Anchor::Base, pose, (least + most) / 2.0)
    });
    Ok(actors.collect())
}

/// A number in [0, 1).
fn part(random: &mut Random) -> f64 {
    (random.next() >> 11) as f64 / (1u64 << 53) as f64
}

/// Points of an area that keep a distance, found by throwing darts; fewer than `count` if too many darts miss.
fn places(area: Area, count: u32, distance: f64, random: &mut Random) -> Vec<DVec2> {
    /// Of so many darts for each point, one should find a place, if there are any.
    const DARTS: u64 = 100;
    let size = area.high - area.low;
    // Points of one cell of the grid or the next may be too near, others not; there are about as many cells as points.
    let per_point = (size.x / f64::from(count) * size.y).sqrt();
    let edge = distance.max(per_point).max(size.max_element() / f64::from(count)).max(f64::MIN_POSITIVE);
    let columns = (size.x / edge) as usize + 1;
    let rows = (size.y / edge) as usize + 1;
    let mut cells = vec![Vec::<DVec2>::new(); columns * rows];
    let mut places = Vec::new();
    for _ in 0..u64::from(count) * DARTS {
        if places.len() == count as usize {
            break;
        }
        let place = (area.low + size * DVec2::new(part(random), part(random))).min(area.high);
        let [column, row] = ((place - area.low) / edge).to_array().map(|cell| cell as usize);
        let [columns_near, rows_near] = [(column, columns), (row, rows)]
            .map(|(cell, cells)| cell.saturating_sub(1)..(cell + 2).min(cells));
        let is_free = rows_near.into_iter().all(|row| {
            let near = &cells[row * columns + columns_near.start..row * columns + columns_near.end];
            near.iter().flatten().all(|other| place.distance_squared(*other) >= distance * distance)
        });
        if is_free {
            cells[row * columns + column].push(place);
            places.push(place);
        }
    }
    places
}
