//! The frame of a plot: axes, marks, a grid, and where a pair of values stands.

use super::axis::Axis;
use super::drawing::{Align, Drawing, Form, Ink, Shape, TEXT_HEIGHT};
use super::font::Letters;
use super::label::Area;

/// Distance between lines of text.
pub const LINE_HEIGHT: f64 = 1.5 * TEXT_HEIGHT;

/// Letters in the page are this much wider than those of the bitmaps, at most.
const READERS_FONT: f64 = 1.08;

/// Two axes around an area.
pub struct Chart<'a> {
    pub area: Area,
    pub x: Axis,
    pub y: Axis,
    letters: &'a Letters,
}

/// Room for a text in the page.
pub fn text_width(letters: &Letters, text: &str) -> f64 {
    letters.width(text) * READERS_FONT
}

impl<'a> Chart<'a> {
    /// A chart within a part of a drawing: what the texts beside it need is taken from that.
    pub fn within(part: &Area, x: Axis, y: Axis, letters: &'a Letters) -> Self {
        let [left, top, right, bottom] = part.0;
        let widest = y.ticks.iter().map(|(_, text)| text_width(letters, text)).fold(0.0, f64::max);
        let left = left + LINE_HEIGHT + widest + 10.0;
        // Half of the last mark's text stands outside.
        let outside = x.ticks.last().map_or(0.0, |(_, text)| text_width(letters, text) / 2.0);
        let area =
            Area([left, top, (right - outside - 2.0).max(left + 1.0), bottom - 2.0 * LINE_HEIGHT - 8.0]);
        Self { area, x, y, letters }
    }

    /// Where a pair of values stands, if both have a place.
    pub fn at(&self, x: f64, y: f64) -> Option<[f64; 2]> {
        Some([self.column(self.x.position(x)?), self.row(self.y.position(y)?)])
    }

    fn column(&self, position: f64) -> f64 {
        let [left, _, right, _] = self.area.0;
        left + position * (right - left)
    }

    fn row(&self, position: f64) -> f64 {
        let [_, top, _, bottom] = self.area.0;
        bottom - position * (bottom - top)
    }

    /// Draws everything but the values.
    pub fn draw_frame(&self, drawing: &mut Drawing) {
        let [left, top, right, bottom] = self.area.0;
        for (value, text) in &self.y.ticks {
            let Some(row) = self.y.position(*value).map(|position| self.row(position)) else { continue };
            drawing.line(&[[left, row], [right, row]], 1.0, Ink::Grid);
            drawing.text(text, [left - 8.0, row], Align::End, Ink::Muted);
        }
        // Marks that have no room for their text are left out, but for their line.
        let mut written = f64::NEG_INFINITY;
        for (value, text) in &self.x.ticks {
            let Some(column) = self.x.position(*value).map(|position| self.column(position)) else {
                continue;
            };
            drawing.line(&[[column, top], [column, bottom]], 1.0, Ink::Grid);
            let half = text_width(self.letters, text) / 2.0;
            if column - half >= written {
                drawing.text(text, [column, bottom + 0.9 * LINE_HEIGHT], Align::Middle, Ink::Muted);
                written = column + half + 6.0;
            }
        }
        drawing.line(&[[left, top], [left, bottom], [right, bottom]], 1.0, Ink::Muted);
        self.draw_breaks(drawing);
        let middle = self.area.middle();
        drawing.text(&self.x.title, [middle[0], bottom + 1.9 * LINE_HEIGHT], Align::Middle, Ink::Text);
        let widest = self.y.ticks.iter().map(|(_, text)| text_width(self.letters, text)).fold(0.0, f64::max);
        let column = left - widest - 10.0 - 0.6 * LINE_HEIGHT;
        let title = drawing.text(&self.y.title, [column, middle[1]], Align::Middle, Ink::Text);
        if let Shape::Text { is_turned, .. } = &mut title.shape {
            *is_turned = true;
        }
    }

    /// Two strokes across an axis whose scale does not reach to its 0.
    fn draw_breaks(&self, drawing: &mut Drawing) {
        let [left, _, _, bottom] = self.area.0;
        for shift in [-2.5, 2.5] {
            if let Some(row) = self.y.zero_break().map(|position| self.row(position) + shift) {
                drawing.line(&[[left - 5.0, row + 2.5], [left + 5.0, row - 2.5]], 1.0, Ink::Muted);
            }
            if let Some(column) = self.x.zero_break().map(|position| self.column(position) + shift) {
                drawing.line(&[[column - 2.5, bottom + 5.0], [column + 2.5, bottom - 5.0]], 1.0, Ink::Muted);
            }
        }
    }
}

/// What an entry of a legend shows before its text.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sample {
    Mark(usize),
    /// A mark on a line, or on a dashed one.
    Series(usize, bool),
    Step,
    Ring,
}

/// Marks with what they mean, in lines of a width. Returns the height of all lines.
pub fn draw_legend(
    drawing: &mut Drawing,
    entries: &[(Sample, String)],
    [left, top]: [f64; 2],
    width: f64,
    letters: &Letters,
) -> f64 {
    let (mut x, mut y) = (left, top + LINE_HEIGHT / 2.0);
    for (sample, text) in entries {
        let length = 34.0 + text_width(letters, text) + 18.0;
        if x > left && x + length - 18.0 > left + width {
            (x, y) = (left, y + LINE_HEIGHT);
        }
        draw_sample(drawing, *sample, [x + 14.0, y]);
        drawing.text(text, [x + 34.0, y], Align::Start, Ink::Text);
        x += length;
    }
    if entries.is_empty() { 0.0 } else { y + LINE_HEIGHT / 2.0 - top }
}

fn draw_sample(drawing: &mut Drawing, sample: Sample, [x, y]: [f64; 2]) {
    match sample {
        Sample::Mark(index) => draw_mark(drawing, [x, y], index),
        Sample::Series(index, is_dashed) => {
            let points = vec![[x - 13.0, y], [x + 13.0, y]];
            drawing.add(Shape::Line { points, width: 1.5, is_dashed }, Ink::Series(index));
            draw_mark(drawing, [x, y], index);
        }
        Sample::Step => {
            let points = [[x - 12.0, y - 5.0], [x, y - 5.0], [x, y + 5.0], [x + 12.0, y + 5.0]];
            drawing.line(&points, 1.5, Ink::Text);
        }
        Sample::Ring => {
            drawing.add(Shape::Ring { middle: [x, y], radius: 7.5, width: 2.0 }, Ink::Text);
        }
    }
}

fn draw_mark(drawing: &mut Drawing, middle: [f64; 2], series: usize) {
    drawing.add(Shape::Mark { middle, radius: 4.5, form: Form::of_series(series) }, Ink::Series(series));
}
