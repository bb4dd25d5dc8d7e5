//! The statement of a texture map: options and the name of a file.

use crate::{Channel, TextureMap, Wrap};

/// A statement such as `map_Kd -s 2 2 1 -clamp on old bark.png`.
#[derive(Debug, PartialEq)]
pub(super) struct TextureStatement<'a> {
    /// How the image lies; the image itself is not yet known.
    pub map: TextureMap,
    /// Whether a channel was chosen (`-imfchan`).
    pub chooses_channel: bool,
    /// The number after `-bm`.
    pub multiplier: Option<f64>,
    /// The file, which may have blanks in its name.
    pub file: &'a str,
    /// Options that are not known, or lack their argument.
    pub odd_options: Vec<&'a str>,
}

impl<'a> TextureStatement<'a> {
    /// Reads what follows the keyword; `None` if no file is named.
    pub(super) fn parse(text: &'a str) -> Option<Self> {
        let mut statement = Self {
            map: TextureMap::new(0),
            chooses_channel: false,
            multiplier: None,
            file: "",
            odd_options: Vec::new(),
        };
        let mut rest = text.trim();
        while rest.starts_with('-') {
            let (option, after) = next_word(rest);
            rest = match statement.option(option, after) {
                Some(after) => after,
                None => {
                    statement.odd_options.push(option);
                    after
                }
            };
        }
        statement.file = rest;
        (!rest.is_empty()).then_some(statement)
    }

    /// Takes an option with its arguments and gives what follows them; `None` if that is not possible.
    fn option(&mut self, option: &str, after: &'a str) -> Option<&'a str> {
        match option {
            "-o" | "-s" | "-t" => {
                let (numbers, after) = numbers(after, 3);
                if numbers.is_empty() {
                    return None;
                }
                // What is not given of an offset is 0, of a scale 1; turbulence (-t) is for procedural textures.
                let target = match option {
                    "-o" => &mut self.map.offset,
                    "-s" => &mut self.map.scale,
                    _ => return Some(after),
                };
                target.iter_mut().zip(numbers).for_each(|(target, number)| *target = number as f32);
                Some(after)
            }
            "-mm" => {
                let (numbers, after) = numbers(after, 2);
                let &[base, gain] = &numbers[..] else { return None };
                (self.map.base, self.map.gain) = (base as f32, gain as f32);
                Some(after)
            }
            "-bm" => {
                let (numbers, after) = numbers(after, 1);
                self.multiplier = Some(*numbers.first()?);
                Some(after)
            }
            "-clamp" => {
                let (word, after) = next_word(after);
                self.map.wrap = [if word == "on" { Wrap::Clamp } else { Wrap::Repeat }; 2];
                matches!(word, "on" | "off").then_some(after)
            }
            "-imfchan" => {
                let (word, after) = next_word(after);
                self.map.channel = match word {
                    "r" => Channel::Red,
                    "g" => Channel::Green,
                    "b" => Channel::Blue,
                    "m" => Channel::Alpha,
                    "l" | "z" => Channel::Luminance,
                    _ => return None,
                };
                self.chooses_channel = true;
                Some(after)
            }
            // They tell a renderer how to filter and to correct, which is not done here.
            "-blendu" | "-blendv" | "-cc" | "-texres" | "-boost" | "-type" => {
                let (word, after) = next_word(after);
                (!word.is_empty()).then_some(after)
            }
            _ => None,
        }
    }
}

/// The first word, and what follows it.
fn next_word(text: &str) -> (&str, &str) {
    let text = text.trim_start();
    let (word, rest) = text.split_at(text.find(char::is_whitespace).unwrap_or(text.len()));
    (word, rest.trim_start())
}

/// Up to `max` numbers at the start of a text, and what follows them. The last word is not taken: it is a file.
fn numbers(mut text: &str, max: usize) -> (Vec<f64>, &str) {
    let mut numbers = Vec::new();
    while numbers.len() < max {
        let (word, after) = next_word(text);
        match word.parse::<f64>() {
            Ok(number) if number.is_finite() && !after.is_empty() => numbers.push(number),
            _ => break,
        }
        text = after;
    }
    (numbers, text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_read_with_their_arguments() {
        let statement = TextureStatement::parse(
            " -blendu on -o 0.5 -s 2 3 1 -mm 0.25 0.5 -bm -2 -clamp on -imfchan r  my tiles\\old bark.png ",
        )
        .unwrap();
        let expected = TextureMap {
            offset: [0.5, 0.0],
            scale: [2.0, 3.0],
            wrap: [Wrap::Clamp; 2],
            channel: Channel::Red,
            base: 0.25,
            gain: 0.5,
            ..TextureMap::new(0)
        };
        assert_eq!(statement.map, expected);
        assert_eq!(statement.multiplier, Some(-2.0));
        assert_eq!(statement.file, "my tiles\\old bark.png");
        assert!(statement.odd_options.is_empty() && statement.chooses_channel);
    }

    #[test]
    fn a_name_may_look_like_a_number() {
        let parse = |text| TextureStatement::parse(text).unwrap();
        assert_eq!(parse("-s 1 2 3").file, "3");
        assert_eq!(parse("-o 1 1 1 4 seasons.png").file, "4 seasons.png");
        assert_eq!(parse("5").map, TextureMap::new(0));
    }

    #[test]
    fn odd_options_do_not_hide_the_file() {
        let parse = |text| TextureStatement::parse(text).unwrap();
        let odd = parse("-shiny -mm 1 bark.png");
        assert_eq!((odd.file, odd.odd_options), ("1 bark.png", vec!["-shiny", "-mm"]));
        let odd = parse("-clamp maybe.png");
        assert_eq!((odd.file, odd.odd_options), ("maybe.png", vec!["-clamp"]));
        for nothing in ["", "  ", "-clamp on", "-bm"] {
            assert_eq!(TextureStatement::parse(nothing), None, "{nothing:?}");
        }
    }
}
