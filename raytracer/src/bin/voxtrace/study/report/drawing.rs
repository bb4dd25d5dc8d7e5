//! A drawing as a list of shapes, which becomes an SVG in the page or pixels in a file.

use super::escape::escape;
use std::fmt::Write;

/// Height of a plot's letters, in the units of its drawing.
pub const TEXT_HEIGHT: f64 = 14.0;

/// Colours by what they are for. The page has those of its colour scheme, bitmaps the light ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ink {
    Text,
    Muted,
    Grid,
    /// Of a series of points, counted from 0.
    Series(usize),
}

/// The colours of series that readers tell apart who do not see all colours: those of Okabe and Ito
/// ("Color universal design", 2008), without yellow, which is faint on white, and with grey for black.
const SERIES: [[u8; 3]; 7] = [
    [0x00, 0x72, 0xb2],
    [0xd5, 0x5e, 0x00],
    [0x00, 0x9e, 0x73],
    [0xc0, 0x62, 0x96],
    [0x56, 0xb4, 0xe9],
    [0xd9, 0x90, 0x00],
    [0x76, 0x7c, 0x82],
];

impl Ink {
    /// On white.
    pub fn color(self) -> [u8; 3] {
        match self {
            Self::Text => [0x1c, 0x24, 0x2b],
            Self::Muted => [0x5a, 0x66, 0x70],
            Self::Grid => [0xdf, 0xe4, 0xe8],
            Self::Series(index) => SERIES[index % SERIES.len()],
        }
    }

    /// A colour that the style sheet defines.
    fn in_page(self) -> String {
        match self {
            Self::Text => "var(--text)".to_string(),
            Self::Muted => "var(--muted)".to_string(),
            Self::Grid => "var(--line)".to_string(),
            Self::Series(index) => format!("var(--series-{})", index % SERIES.len()),
        }
    }
}

/// Forms of marks, so that series differ by more than their colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    Circle,
    Square,
    Triangle,
    Diamond,
    TriangleDown,
}

impl Form {
    /// Of a series, counted from 0. Five forms and seven colours make 35 different marks.
    pub fn of_series(index: usize) -> Self {
        const FORMS: [Form; 5] =
            [Form::Circle, Form::Square, Form::Triangle, Form::Diamond, Form::TriangleDown];
        FORMS[index % FORMS.len()]
    }

    /// Corners relative to the middle, for a mark that covers about as much as a circle of radius 1;
    /// none for a circle.
    pub fn corners(self) -> &'static [[f64; 2]] {
        match self {
            Self::Circle => &[],
            Self::Square => &[[-0.89, -0.89], [0.89, -0.89], [0.89, 0.89], [-0.89, 0.89]],
            Self::Triangle => &[[0.0, -1.35], [1.25, 0.85], [-1.25, 0.85]],
            Self::Diamond => &[[0.0, -1.3], [1.3, 0.0], [0.0, 1.3], [-1.3, 0.0]],
            Self::TriangleDown => &[[0.0, 1.35], [1.25, -0.85], [-1.25, -0.85]],
        }
    }
}

/// Which part of a text stands at its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Align {
    Start,
    Middle,
    End,
}

/// A shape. Places are in units of the drawing, from its upper left corner.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    Line {
        points: Vec<[f64; 2]>,
        width: f64,
        is_dashed: bool,
    },
    /// A circle that is not filled.
    Ring {
        middle: [f64; 2],
        radius: f64,
        width: f64,
    },
    /// A filled mark.
    Mark {
        middle: [f64; 2],
        radius: f64,
        form: Form,
    },
    /// A line of text; its place is the middle of its height.
    Text {
        text: String,
        at: [f64; 2],
        align: Align,
        is_bold: bool,
        /// Read from below.
        is_turned: bool,
        /// Whether what it stands on shines through around the letters only.
        has_halo: bool,
    },
}

/// A shape with its looks.
#[derive(Debug, Clone, PartialEq)]
pub struct Item {
    pub shape: Shape,
    pub ink: Ink,
    pub opacity: f64,
    /// What a pointer over it is told; empty for nothing.
    pub hint: String,
}

/// A drawing.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    /// Width and height.
    pub size: [f64; 2],
    /// What it shows, for those who do not see it.
    pub description: String,
    /// From back to front.
    pub items: Vec<Item>,
}

impl Drawing {
    pub fn new(size: [f64; 2], description: String) -> Self {
        Self { size, description, items: Vec::new() }
    }

    pub fn add(&mut self, shape: Shape, ink: Ink) -> &mut Item {
        self.items.push(Item { shape, ink, opacity: 1.0, hint: String::new() });
        let last = self.items.len() - 1;
        &mut self.items[last]
    }

    pub fn line(&mut self, points: &[[f64; 2]], width: f64, ink: Ink) -> &mut Item {
        self.add(Shape::Line { points: points.to_vec(), width, is_dashed: false }, ink)
    }

    pub fn text(&mut self, text: &str, at: [f64; 2], align: Align, ink: Ink) -> &mut Item {
        let text = text.to_string();
        self.add(Shape::Text { text, at, align, is_bold: false, is_turned: false, has_halo: false }, ink)
    }

    /// Puts another drawing into this one.
    pub fn place(&mut self, other: &Self, offset: [f64; 2]) {
        self.items.extend(other.items.iter().cloned().map(|mut item| {
            item.shape.shift(offset);
            item
        }));
    }

    /// As an element of the page. Colours are those of the style sheet.
    pub fn to_svg(&self, class: &str) -> String {
        let [width, height] = self.size;
        let mut svg = format!(
            "<svg class=\"{class}\" viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{}\">\n",
            escape(&self.description)
        );
        for item in &self.items {
            let opacity = match item.opacity < 1.0 {
                true => format!(" opacity=\"{}\"", rounded(item.opacity)),
                false => String::new(),
            };
            let (open, close) = match item.hint.is_empty() {
                true => (String::new(), ""),
                false => (format!("<g><title>{}</title>", escape(&item.hint)), "</g>"),
            };
            let _ = writeln!(svg, "{open}{}{close}", item.shape.to_svg(&item.ink.in_page(), &opacity));
        }
        svg.push_str("</svg>\n");
        svg
    }
}

impl Shape {
    fn shift(&mut self, [dx, dy]: [f64; 2]) {
        let points = match self {
            Self::Line { points, .. } => points.as_mut_slice(),
            Self::Ring { middle, .. } | Self::Mark { middle, .. } => std::slice::from_mut(middle),
            Self::Text { at, .. } => std::slice::from_mut(at),
        };
        for [x, y] in points {
            *x += dx;
            *y += dy;
        }
    }

    fn to_svg(&self, ink: &str, opacity: &str) -> String {
        let pairs = |points: &mut dyn Iterator<Item = [f64; 2]>| {
            points.map(|[x, y]| format!("{},{}", rounded(x), rounded(y))).collect::<Vec<_>>().join(" ")
        };
        match self {
            Self::Line { points, width, is_dashed } => {
                let dashes = if *is_dashed { " stroke-dasharray=\"6 4\"" } else { "" };
                let points = pairs(&mut points.iter().copied());
                format!(
                    "<polyline points=\"{points}\" fill=\"none\" stroke=\"{ink}\" stroke-width=\"{width}\"\
                     {dashes}{opacity} />"
                )
            }
            Self::Ring { middle: [x, y], radius, width } => format!(
                "<circle cx=\"{}\" cy=\"{}\" r=\"{radius}\" fill=\"none\" stroke=\"{ink}\" \
                 stroke-width=\"{width}\"{opacity} />",
                rounded(*x),
                rounded(*y)
            ),
            Self::Mark { middle: [x, y], radius, form: Form::Circle } => format!(
                "<circle cx=\"{}\" cy=\"{}\" r=\"{radius}\" fill=\"{ink}\"{opacity} />",
                rounded(*x),
                rounded(*y)
            ),
            Self::Mark { middle: [x, y], radius, form } => {
                let corner = |[dx, dy]: &[f64; 2]| [x + dx * radius, y + dy * radius];
                let corners = pairs(&mut form.corners().iter().map(corner));
                format!("<polygon points=\"{corners}\" fill=\"{ink}\"{opacity} />")
            }
            Self::Text { text, at: [x, y], align, is_bold, is_turned, has_halo } => {
                let (x, y) = (rounded(*x), rounded(*y));
                let anchor = match align {
                    Align::Start => "start",
                    Align::Middle => "middle",
                    Align::End => "end",
                };
                let weight = if *is_bold { " font-weight=\"bold\"" } else { "" };
                let halo = if *has_halo { " class=\"halo\"" } else { "" };
                let turn = match is_turned {
                    true => format!(" transform=\"rotate(-90 {x} {y})\""),
                    false => String::new(),
                };
                format!(
                    "<text{halo} x=\"{x}\" y=\"{y}\" dy=\"0.35em\" text-anchor=\"{anchor}\" \
                     font-size=\"{TEXT_HEIGHT}\" fill=\"{ink}\"{weight}{turn}{opacity}>{}</text>",
                    escape(text)
                )
            }
        }
    }
}

/// To hundredths, which are finer than a screen's pixels.
fn rounded(value: f64) -> f64 {
    (value * 100.0).round() / 100.0
}
