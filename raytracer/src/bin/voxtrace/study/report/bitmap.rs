//! Drawings as PNG files.

use super::drawing::{Align, Drawing, Form, Ink, Item, Shape, TEXT_HEIGHT};
use super::font::Letters;
use anyhow::{Context, anyhow};
use image::imageops::{FilterType, resize};
use image::{ImageFormat, RgbImage};
use plotters::coord::Shift;
use plotters::prelude::{
    BitMapBackend, Circle, Color, DrawingArea, IntoDrawingArea, PathElement, Polygon, RGBAColor, RGBColor,
    Rectangle, ShapeStyle, WHITE,
};
use std::f64::consts::TAU;
use std::io::Cursor;

/// Drawn this many times larger and made smaller then, so that edges are smooth.
const OVERSAMPLING: f64 = 2.0;

/// Lengths of the dashes of a line and of the gaps between them.
const DASHES: [f64; 2] = [6.0, 4.0];

type Area<'a> = DrawingArea<BitMapBackend<'a>, Shift>;

/// The bytes of a PNG file of a drawing.
///
/// # Errors
/// If the file cannot be made.
pub fn to_png(drawing: &Drawing, width: u32) -> anyhow::Result<Vec<u8>> {
    let picture = to_picture(drawing, width)?;
    let mut bytes = Cursor::new(Vec::new());
    picture.write_to(&mut bytes, ImageFormat::Png).context("cannot make a picture of a plot")?;
    Ok(bytes.into_inner())
}

fn to_picture(drawing: &Drawing, width: u32) -> anyhow::Result<RgbImage> {
    let height = (f64::from(width) * drawing.size[1] / drawing.size[0]).round() as u32;
    let [columns, rows] = [width, height].map(|length| length * OVERSAMPLING as u32);
    let mut large = RgbImage::new(columns, rows);
    let scale = f64::from(columns) / drawing.size[0];
    let canvas = Canvas {
        area: BitMapBackend::with_buffer(&mut large, (columns, rows)).into_drawing_area(),
        scale,
        letters: Letters::of_height(TEXT_HEIGHT * scale)?,
    };
    canvas.draw(drawing)?;
    drop(canvas);
    Ok(resize(&large, width, height, FilterType::Triangle))
}

struct Canvas<'a> {
    area: Area<'a>,
    /// Pixels of a unit of the drawing.
    scale: f64,
    letters: Letters,
}

impl Canvas<'_> {
    fn draw(&self, drawing: &Drawing) -> anyhow::Result<()> {
        self.area.fill(&WHITE).map_err(failure)?;
        drawing.items.iter().try_for_each(|item| self.draw_item(item))?;
        self.area.present().map_err(failure)
    }

    fn draw_item(&self, item: &Item) -> anyhow::Result<()> {
        let color = color(item.ink, item.opacity);
        match &item.shape {
            Shape::Line { points, width, is_dashed: false } => self.line(points, *width, color),
            Shape::Line { points, width, is_dashed: true } => {
                dashes(points).iter().try_for_each(|dash| self.line(dash, *width, color))
            }
            Shape::Ring { middle, radius, width } => {
                // A polygon, once around outside and back inside, because a circle's stroke has gaps.
                let corner = |index: i32, radius: f64| {
                    let (sin, cos) = (f64::from(index) / 60.0 * TAU).sin_cos();
                    self.pixel([middle[0] + radius * cos, middle[1] + radius * sin])
                };
                let outside = (0..=60).map(|index| corner(index, radius + width / 2.0));
                let inside = (0..=60).rev().map(|index| corner(index, radius - width / 2.0));
                let corners: Vec<_> = outside.chain(inside).collect();
                self.area.draw(&Polygon::new(corners, color.filled())).map_err(failure)
            }
            Shape::Mark { middle, radius, form: Form::Circle } => {
                let radius = (radius * self.scale).round() as i32;
                self.area.draw(&Circle::new(self.pixel(*middle), radius, color.filled())).map_err(failure)
            }
            Shape::Mark { middle: [x, y], radius, form } => {
                let corner = |[dx, dy]: &[f64; 2]| self.pixel([x + dx * radius, y + dy * radius]);
                let corners: Vec<_> = form.corners().iter().map(corner).collect();
                self.area.draw(&Polygon::new(corners, color.filled())).map_err(failure)
            }
            Shape::Text { text, at, align, is_bold, is_turned, has_halo } => {
                let [x, y] = at.map(|place| place * self.scale);
                let width = self.letters.width(text);
                let left = match align {
                    Align::Start => 0.0,
                    Align::Middle => -width / 2.0,
                    Align::End => -width,
                };
                if *has_halo && !is_turned {
                    self.clear([x + left, y], width)?;
                }
                // Bold letters are written twice, a little apart.
                let shifts: &[f64] = if *is_bold { &[-0.02, 0.02] } else { &[0.0] };
                for shift in shifts {
                    let left = left + shift * TEXT_HEIGHT * self.scale;
                    self.text(
                        text,
                        |along, down| match is_turned {
                            true => [x + down, y - left - along],
                            false => [x + left + along, y + down],
                        },
                        color,
                    )?;
                }
                Ok(())
            }
        }
    }

    fn line(&self, points: &[[f64; 2]], width: f64, color: RGBAColor) -> anyhow::Result<()> {
        let stroke_width = (width * self.scale).round().max(1.0) as u32;
        let points: Vec<_> = points.iter().map(|&point| self.pixel(point)).collect();
        let style = ShapeStyle { color, filled: false, stroke_width };
        self.area.draw(&PathElement::new(points, style)).map_err(failure)
    }

    /// Takes most of what is there away below a text.
    fn clear(&self, [left, middle]: [f64; 2], width: f64) -> anyhow::Result<()> {
        let (half, side) = (0.55 * TEXT_HEIGHT * self.scale, 2.0 * self.scale);
        let corners = [
            ((left - side).round() as i32, (middle - half).round() as i32),
            ((left + width + side).round() as i32, (middle + half).round() as i32),
        ];
        self.area.draw(&Rectangle::new(corners, WHITE.mix(0.75).filled())).map_err(failure)
    }

    /// Writes a text; `to_pixel` says where a place along it and below its middle is.
    fn text(
        &self,
        text: &str,
        to_pixel: impl Fn(f64, f64) -> [f64; 2],
        color: RGBAColor,
    ) -> anyhow::Result<()> {
        let mut done = Ok(());
        self.letters.draw(text, |along, down, coverage| {
            let [x, y] = to_pixel(along, down).map(|place| place.round() as i32);
            let color = color.mix(f64::from(coverage.clamp(0.0, 1.0)));
            if let Err(error) = self.area.draw_pixel((x, y), &color) {
                done = Err(failure(error));
            }
        });
        done
    }

    fn pixel(&self, place: [f64; 2]) -> (i32, i32) {
        let [x, y] = place.map(|place| (place * self.scale).round() as i32);
        (x, y)
    }
}

fn color(ink: Ink, opacity: f64) -> RGBAColor {
    let [red, green, blue] = ink.color();
    RGBColor(red, green, blue).mix(opacity)
}

fn failure(error: impl std::fmt::Display) -> anyhow::Error {
    anyhow!("cannot draw a plot: {error}")
}

/// The dashes of a dashed line.
fn dashes(points: &[[f64; 2]]) -> Vec<Vec<[f64; 2]>> {
    let mut dashes = Vec::new();
    let (mut is_on, mut left) = (true, DASHES[0]);
    let mut dash: Vec<[f64; 2]> = points.first().copied().into_iter().collect();
    for pair in points.windows(2) {
        let [from, to] = [pair[0], pair[1]];
        let length = (to[0] - from[0]).hypot(to[1] - from[1]);
        let at = |along: f64| [0, 1].map(|axis| from[axis] + (to[axis] - from[axis]) * along / length);
        let mut along = 0.0;
        while length - along > left {
            along += left;
            dash.push(at(along));
            if is_on {
                dashes.push(std::mem::take(&mut dash));
            }
            is_on = !is_on;
            left = DASHES[usize::from(!is_on)];
            dash = vec![at(along)];
        }
        left -= length - along;
        dash.push(to);
    }
    if is_on && dash.len() > 1 {
        dashes.push(dash);
    }
    dashes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_are_where_they_belong() {
        let mut drawing = Drawing::new([100.0, 50.0], String::new());
        drawing.add(Shape::Mark { middle: [25.0, 25.0], radius: 5.0, form: Form::Square }, Ink::Series(1));
        drawing.line(&[[60.0, 0.0], [60.0, 50.0]], 4.0, Ink::Text);
        drawing.text("HHHH", [99.0, 25.0], Align::End, Ink::Text);
        let picture = to_picture(&drawing, 200).unwrap();
        assert_eq!(picture.dimensions(), (200, 100));
        assert_eq!(picture.get_pixel(50, 50).0, Ink::Series(1).color());
        assert_eq!(picture.get_pixel(120, 20).0, Ink::Text.color());
        assert_eq!(picture.get_pixel(10, 10).0, [255; 3]);
        let is_text = |column| (40..60).any(|row| picture.get_pixel(column, row).0[0] < 128);
        assert!((130..198).filter(|&column| is_text(column)).count() > 20);
        assert!(!is_text(199));
    }

    #[test]
    fn dashes_go_on_around_corners() {
        let dashes = dashes(&[[0.0, 0.0], [8.0, 0.0], [8.0, 20.0]]);
        let expected: [&[[f64; 2]]; 3] =
            [&[[0.0, 0.0], [6.0, 0.0]], &[[8.0, 2.0], [8.0, 8.0]], &[[8.0, 12.0], [8.0, 18.0]]];
        assert_eq!(dashes, expected);
    }
}
