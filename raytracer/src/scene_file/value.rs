//! Numbers, points and colours of a scene file. What they cannot be is refused as they are read, so that the error knows
//! their place.

use crate::color::{Light3, to_linear};
use glam::{DQuat, DVec3, Vec3};
use serde::de::{Deserialize, Deserializer, Error, SeqAccess, Visitor};

/// Beyond this, squares of numbers no longer fit single precision well; below its inverse, they vanish.
const LARGEST: f64 = 1e12;

/// A number as it is shown in an error, with an exponent if it is very large or small.
fn shown(number: f64) -> String {
    let text = format!("{number:?}");
    text.strip_suffix(".0").unwrap_or(&text).into()
}

/// Defines a number that is checked as it is read.
macro_rules! number {
    ($(#[$doc:meta])* $name:ident($of:ty), $accepted:expr, $expected:expr) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, serde::Deserialize)]
        #[serde(try_from = "f64")]
        pub(super) struct $name(pub $of);

        impl TryFrom<f64> for $name {
            type Error = String;

            fn try_from(number: f64) -> Result<Self, String> {
                let accepted: fn(f64) -> bool = $accepted;
                if accepted(number) {
                    Ok(Self(number as $of))
                } else {
                    Err(format!("found {}, expected {}", shown(number), $expected))
                }
            }
        }
    };
}

number!(
    /// Any finite number.
    Number(f64),
    |number| number.abs() <= LARGEST,
    format!("a number from {:e} to {LARGEST:e}", -LARGEST)
);
number!(
    /// Above zero.
    Positive(f64),
    |number| (1.0 / LARGEST..=LARGEST).contains(&number),
    format!("a number above zero, from {:e} to {LARGEST:e}", 1.0 / LARGEST)
);
number!(
    /// Zero or more.
    NotNegative(f64),
    |number| (0.0..=LARGEST).contains(&number),
    format!("a number from 0 to {LARGEST:e}")
);
number!(
    /// Zero or more, and infinity.
    MaybeInfinite(f64),
    |number| (0.0..=LARGEST).contains(&number) || number == f64::INFINITY,
    format!("a number from 0 to {LARGEST:e}, or inf")
);
number!(
    /// From 0 to 1.
    Share(f32),
    |number| (0.0..=1.0).contains(&number),
    "a number from 0 to 1"
);
number!(
    /// Degrees that a plane picture can have from one edge to the other.
    FieldOfView(f64),
    |degrees| (0.001..=179.0).contains(&degrees),
    "degrees from 0.001 to 179"
);
number!(
    /// Degrees of what looks like a disk.
    DiskAngle(f64),
    |degrees| (0.0..180.0).contains(&degrees),
    "degrees from 0 to less than 180"
);

/// Defines a whole number that is checked as it is read.
macro_rules! whole_number {
    ($(#[$doc:meta])* $name:ident, $range:expr) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
        #[serde(try_from = "i64")]
        pub(super) struct $name(pub u32);

        impl TryFrom<i64> for $name {
            type Error = String;

            fn try_from(number: i64) -> Result<Self, String> {
                let range = $range;
                if range.contains(&number) {
                    Ok(Self(number as u32))
                } else {
                    Err(format!("found {number}, expected {} to {}", range.start(), range.end()))
                }
            }
        }
    };
}

whole_number!(
    /// Number of a frame.
    FrameNumber,
    0..=999_999
);
whole_number!(
    /// How many frames there are, or how many things.
    Amount,
    1..=1_000_000
);
whole_number!(
    /// How many rays are sent for one thing.
    Rays,
    1..=65_536
);
whole_number!(
    /// How many rays are sent from a point that one ray has met: all of a tile wait in memory.
    RaysEach,
    1..=1024
);
whole_number!(
    /// How often light is mirrored or bent, if at all.
    Times,
    0..=64
);

/// A point of the scene, or a length along each axis.
#[derive(Debug, Clone, Copy, PartialEq, serde::Deserialize)]
#[serde(try_from = "[f64; 3]")]
pub(super) struct Point(pub DVec3);

impl TryFrom<[f64; 3]> for Point {
    type Error = String;

    fn try_from([x, y, z]: [f64; 3]) -> Result<Self, String> {
        let [x, y, z] = [Number::try_from(x)?, Number::try_from(y)?, Number::try_from(z)?];
        Ok(Self(DVec3::new(x.0, y.0, z.0)))
    }
}

/// A direction in the scene, a unit vector.
#[derive(Debug, Clone, Copy, PartialEq, serde::Deserialize)]
#[serde(try_from = "[f64; 3]")]
pub(super) struct Direction(pub DVec3);

impl TryFrom<[f64; 3]> for Direction {
    type Error = String;

    fn try_from(parts: [f64; 3]) -> Result<Self, String> {
        let Point(direction) = Point::try_from(parts)?;
        if direction.length() < 1.0 / LARGEST {
            return Err(format!("found {parts:?}, expected a direction, which is not zero"));
        }
        Ok(Self(direction.normalize()))
    }
}

/// A rotation, given as degrees about x, then about y, then about z, the axes of the scene.
#[derive(Debug, Clone, Copy, PartialEq, serde::Deserialize)]
#[serde(try_from = "[f64; 3]")]
pub(super) struct Turn(pub DQuat);

impl TryFrom<[f64; 3]> for Turn {
    type Error = String;

    fn try_from(parts: [f64; 3]) -> Result<Self, String> {
        let [x, y, z] = Point::try_from(parts)?.0.to_array().map(f64::to_radians);
        let rotation = DQuat::from_rotation_z(z) * DQuat::from_rotation_y(y) * DQuat::from_rotation_x(x);
        Ok(Self(rotation.normalize()))
    }
}

/// Amounts of light, given as red, green and blue, as one number for all three, or as a displayed colour "#rrggbb".
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Color(pub Light3);

/// As [`Color`], none of the amounts more than 1.
#[derive(Debug, Clone, Copy, PartialEq, serde::Deserialize)]
#[serde(try_from = "Color")]
pub(super) struct ColorShare(pub Light3);

impl TryFrom<Color> for ColorShare {
    type Error = String;

    fn try_from(Color(color): Color) -> Result<Self, String> {
        if color.max_element() <= 1.0 {
            Ok(Self(color))
        } else {
            Err(format!("found {color}, expected shares from 0 to 1"))
        }
    }
}

/// A colour as it is displayed, in sRGB, given as "#rrggbb".
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[serde(try_from = "String")]
pub(super) struct Displayed(pub [u8; 3]);

impl TryFrom<String> for Displayed {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        displayed(&text).map(Self)
    }
}

impl std::fmt::Display for Displayed {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [red, green, blue] = self.0;
        write!(formatter, "#{red:02x}{green:02x}{blue:02x}")
    }
}

fn displayed(text: &str) -> Result<[u8; 3], String> {
    let digits = text.strip_prefix('#').filter(|digits| digits.len() == 6);
    let digits = digits.filter(|digits| digits.bytes().all(|digit| digit.is_ascii_hexdigit()));
    let number = digits.and_then(|digits| u32::from_str_radix(digits, 16).ok());
    let [_, color @ ..] = number
        .ok_or_else(|| format!("found \"{text}\", expected a colour such as \"#ff8800\""))?
        .to_be_bytes();
    Ok(color)
}

impl<'de> Deserialize<'de> for Color {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(ColorVisitor)
    }
}

struct ColorVisitor;

impl<'de> Visitor<'de> for ColorVisitor {
    type Value = Color;

    fn expecting(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter
            .write_str("[red, green, blue] as amounts of light, one number for all three, or \"#rrggbb\"")
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Color, E> {
        let color = displayed(text).map_err(E::custom)?;
        Ok(Color(Vec3::from_array(color.map(to_linear))))
    }

    fn visit_i64<E: Error>(self, amount: i64) -> Result<Color, E> {
        self.visit_f64(amount as f64)
    }

    fn visit_f64<E: Error>(self, amount: f64) -> Result<Color, E> {
        let NotNegative(amount) = NotNegative::try_from(amount).map_err(E::custom)?;
        Ok(Color(Vec3::splat(amount as f32)))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut parts: A) -> Result<Color, A::Error> {
        let mut color = [0.0; 3];
        for (place, part) in color.iter_mut().enumerate() {
            let NotNegative(amount) =
                parts.next_element()?.ok_or_else(|| A::Error::invalid_length(place, &self))?;
            *part = amount as f32;
        }
        match parts.next_element::<NotNegative>()? {
            Some(_) => Err(A::Error::invalid_length(4, &self)),
            None => Ok(Color(Vec3::from_array(color))),
        }
    }
}
