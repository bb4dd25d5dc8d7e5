//! Which models are where: the graph of places, groups and shapes.

use super::super::ExchangeError;
use super::chunks::{Bytes, Dictionary};
use std::collections::{BTreeMap, BTreeSet};

/// Places, groups and shapes that are visited. Those that are reached in several ways count as often.
const MAX_VISITS: u64 = 1 << 20;

/// A turn by quarters, or a reflection: row k of its matrix has ±1 in one column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Rotation {
    columns: [usize; 3],
    signs: [i64; 3],
}

impl Rotation {
    pub const NONE: Self = Self { columns: [0, 1, 2], signs: [1; 3] };

    /// From a byte: bits 0 and 1 are the column of the first row, 2 and 3 that of the second; bits 4 to 6 are set where the
    /// sign is negative.
    pub fn from_byte(byte: u8) -> Option<Self> {
        let [first, second] = [byte & 3, byte >> 2 & 3].map(usize::from);
        if first > 2 || second > 2 || first == second || byte >= 128 {
            return None;
        }
        let sign = |row: usize| if byte >> (4 + row) & 1 == 1 { -1 } else { 1 };
        Some(Self { columns: [first, second, 3 - first - second], signs: std::array::from_fn(sign) })
    }

    pub fn apply(self, vector: [i64; 3]) -> [i64; 3] {
        std::array::from_fn(|row| self.signs[row] * vector[self.columns[row]])
    }

    /// First `other`, then this.
    fn after(self, other: Self) -> Self {
        Self {
            columns: self.columns.map(|column| other.columns[column]),
            signs: std::array::from_fn(|row| self.signs[row] * other.signs[self.columns[row]]),
        }
    }
}

/// Where something is: it is turned, then moved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Place {
    pub rotation: Rotation,
    pub translation: [i64; 3],
}

impl Place {
    pub const ORIGIN: Self = Self { rotation: Rotation::NONE, translation: [0; 3] };

    /// The place of what has the place `inner` in something that is here.
    fn of(self, inner: Self) -> Self {
        let moved = self.rotation.apply(inner.translation);
        Self {
            rotation: self.rotation.after(inner.rotation),
            // Of at most 2²⁰ numbers below 2³¹.
            translation: std::array::from_fn(|axis| self.translation[axis] + moved[axis]),
        }
    }

    /// From the dictionary of a frame.
    fn from_frame(frame: &Dictionary, offset: u64) -> Result<Self, ExchangeError> {
        let damaged =
            |field, value: &String| ExchangeError::DamagedField { offset, field, value: value.clone() };
        let mut place = Self::ORIGIN;
        if let Some(text) = frame.get("_r") {
            let rotation = text.trim().parse().ok().and_then(Rotation::from_byte);
            place.rotation = rotation.ok_or_else(|| damaged("rotation", text))?;
        }
        if let Some(text) = frame.get("_t") {
            let numbers: Vec<i32> = text.split_whitespace().map_while(|number| number.parse().ok()).collect();
            let numbers: [i32; 3] = numbers.try_into().map_err(|_| damaged("translation", text))?;
            place.translation = numbers.map(i64::from);
        }
        Ok(place)
    }
}

#[derive(Debug)]
enum Node {
    Transform {
        child: u32,
        layer: u32,
        place: Place,
        is_hidden: bool,
    },
    Group {
        children: Vec<u32>,
    },
    /// The first model: others are further pictures of an animation.
    Shape {
        model: Option<u32>,
    },
}

/// The graph of a file.
#[derive(Debug, Default)]
pub(super) struct Scene {
    nodes: BTreeMap<u32, Node>,
    hidden_layers: BTreeSet<u32>,
}

fn is_hidden(attributes: &Dictionary) -> bool {
    attributes.get("_hidden").is_some_and(|value| value == "1")
}

impl Scene {
    /// Takes the content of a chunk nTRN. Of several frames the first counts.
    pub fn add_transform(&mut self, mut content: Bytes<'_>) -> Result<(), ExchangeError> {
        const PART: &str = "place of a model";
        let offset = content.offset;
        let node = content.number(PART)?;
        let is_hidden = is_hidden(&content.dictionary(PART)?);
        let child = content.number(PART)?;
        content.number(PART)?;
        let layer = content.number(PART)?;
        let place = match content.count(4, PART)? {
            0 => Place::ORIGIN,
            _ => Place::from_frame(&content.dictionary(PART)?, offset)?,
        };
        self.nodes.insert(node, Node::Transform { child, layer, place, is_hidden });
        Ok(())
    }

    /// Takes the content of a chunk nGRP.
    pub fn add_group(&mut self, mut content: Bytes<'_>) -> Result<(), ExchangeError> {
        const PART: &str = "group of models";
        let node = content.number(PART)?;
        content.dictionary(PART)?;
        let count = content.count(4, PART)?;
        let children = (0..count).map(|_| content.number(PART)).collect::<Result<_, _>>()?;
        self.nodes.insert(node, Node::Group { children });
        Ok(())
    }

    /// Takes the content of a chunk nSHP.
    pub fn add_shape(&mut self, mut content: Bytes<'_>) -> Result<(), ExchangeError> {
        const PART: &str = "shape";
        let node = content.number(PART)?;
        content.dictionary(PART)?;
        let model = match content.count(8, PART)? {
            0 => None,
            _ => Some(content.number(PART)?),
        };
        self.nodes.insert(node, Node::Shape { model });
        Ok(())
    }

    /// Takes the content of a chunk LAYR.
    pub fn add_layer(&mut self, mut content: Bytes<'_>) -> Result<(), ExchangeError> {
        const PART: &str = "layer";
        let layer = content.number(PART)?;
        if is_hidden(&content.dictionary(PART)?) {
            self.hidden_layers.insert(layer);
        }
        Ok(())
    }

    /// Whether the file says nothing about places.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// The models that are shown, each as often as it is, and where, in the order of the graph.
    pub fn models(&self) -> Result<Vec<(u32, Place)>, ExchangeError> {
        let mut models = Vec::new();
        let mut visits = 0;
        let mut open = vec![(0, Place::ORIGIN)];
        while let Some((node, place)) = open.pop() {
            visits += 1;
            if visits > MAX_VISITS || open.len() as u64 > MAX_VISITS {
                return Err(ExchangeError::SceneTooLarge { what: "nodes", limit: MAX_VISITS });
            }
            match self.nodes.get(&node) {
                Some(Node::Transform { is_hidden: true, .. }) | None => {}
                Some(Node::Transform { layer, .. }) if self.hidden_layers.contains(layer) => {}
                Some(Node::Transform { child, place: inner, .. }) => open.push((*child, place.of(*inner))),
                Some(Node::Group { children }) => {
                    open.extend(children.iter().rev().map(|child| (*child, place)));
                }
                Some(Node::Shape { model }) => models.extend(model.map(|model| (model, place))),
            }
        }
        Ok(models)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The matrices of the description of the format, row by row.
    #[test]
    fn rotations_are_signed_permutations() {
        // [0 1 0], [0 0 −1], [−1 0 0]: the example of the description.
        let rotation = Rotation::from_byte(1 | 2 << 2 | 1 << 5 | 1 << 6).unwrap();
        assert_eq!(rotation.apply([10, 20, 30]), [20, -30, -10]);
        assert_eq!(Rotation::from_byte(4), Some(Rotation::NONE));
        let valid = (0..=u8::MAX).filter_map(Rotation::from_byte).count();
        assert_eq!(valid, 48);
    }

    #[test]
    fn places_follow_one_another() {
        let all: Vec<Rotation> = (0..=u8::MAX).filter_map(Rotation::from_byte).collect();
        let point = [3, -5, 8];
        let go = |place: Place, point| {
            let turned = place.rotation.apply(point);
            std::array::from_fn(|axis| turned[axis] + place.translation[axis])
        };
        for &a in &all {
            for &b in &all {
                let (outer, inner) = (
                    Place { rotation: a, translation: [1, 2, 3] },
                    Place { rotation: b, translation: [40, 50, 60] },
                );
                let found: [i64; 3] = go(outer.of(inner), point);
                assert_eq!(found, go(outer, go(inner, point)));
            }
        }
    }

    #[test]
    fn an_endless_scene_is_refused() {
        let mut scene = Scene::default();
        scene.nodes.insert(0, Node::Group { children: vec![0, 0] });
        assert!(matches!(scene.models(), Err(ExchangeError::SceneTooLarge { what: "nodes", .. })));
    }
}
