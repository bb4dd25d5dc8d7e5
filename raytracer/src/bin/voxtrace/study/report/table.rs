//! Tables of the page, which sort themselves by the column whose head is clicked on.

use super::escape::escape;
use super::number::{NOTHING, figure};
use std::fmt::Write;

/// A table, column by column. The first column names the rows.
#[derive(Debug, Clone, Default)]
pub struct Table {
    pub columns: Vec<Column>,
}

/// What a column holds, which decides how it looks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Text,
    Figures,
    Commands,
}

/// A column.
#[derive(Debug, Clone)]
pub struct Column {
    head: String,
    unit: String,
    /// A heading over several columns that stand together; empty for none.
    group: String,
    kind: Kind,
    cells: Vec<Cell>,
}

/// A cell. What it sorts by is not always what it shows.
#[derive(Debug, Clone)]
struct Cell {
    html: String,
    value: Option<f64>,
}

impl Column {
    /// Text that is escaped already, sorted by its place in the table.
    pub fn of_html(head: &str, texts: impl IntoIterator<Item = String>) -> Self {
        let cell = |(index, html)| Cell { html, value: Some(index as f64) };
        Self::new(head, "", Kind::Text, texts.into_iter().enumerate().map(cell))
    }

    /// Plain text, sorted by the alphabet.
    pub fn texts<'a>(head: &str, texts: impl IntoIterator<Item = &'a str>) -> Self {
        let cell = |text: &str| Cell { html: escape(text), value: None };
        Self::new(head, "", Kind::Text, texts.into_iter().map(cell))
    }

    /// Numbers.
    pub fn figures(head: &str, unit: &str, values: impl IntoIterator<Item = Option<f64>>) -> Self {
        let cell = |value: Option<f64>| Cell { html: value.map_or(NOTHING.to_string(), figure), value };
        Self::new(head, unit, Kind::Figures, values.into_iter().map(cell))
    }

    /// Numbers written in their own way.
    pub fn written<'a>(head: &str, cells: impl IntoIterator<Item = (&'a str, Option<f64>)>) -> Self {
        let cell = |(text, value)| Cell { html: escape(text), value };
        Self::new(head, "", Kind::Figures, cells.into_iter().map(cell))
    }

    /// What is typed.
    pub fn commands<'a>(head: &str, texts: impl IntoIterator<Item = &'a str>) -> Self {
        let cell = |text: &str| Cell { html: format!("<code>{}</code>", escape(text)), value: None };
        Self::new(head, "", Kind::Commands, texts.into_iter().map(cell))
    }

    /// Under a heading with its neighbours.
    #[must_use]
    pub fn in_group(mut self, group: &str) -> Self {
        self.group = group.to_string();
        self
    }

    fn new(head: &str, unit: &str, kind: Kind, cells: impl Iterator<Item = Cell>) -> Self {
        let (head, unit) = (head.to_string(), unit.to_string());
        Self { head, unit, group: String::new(), kind, cells: cells.collect() }
    }

    /// Whether any of its cells says something.
    fn has_content(&self) -> bool {
        match self.kind {
            Kind::Figures => self.cells.iter().any(|cell| cell.value.is_some()),
            Kind::Text | Kind::Commands => true,
        }
    }
}

impl Table {
    /// A table of those columns in which there is something.
    pub fn of(columns: impl IntoIterator<Item = Column>) -> Self {
        Self { columns: columns.into_iter().filter(Column::has_content).collect() }
    }

    /// As an element of the page.
    pub fn to_html(&self) -> String {
        let mut html = "<div class=\"scroll\"><table class=\"sortable\">\n<thead>\n".to_string();
        let has_groups = self.columns.iter().any(|column| !column.group.is_empty());
        if has_groups {
            html.push_str("<tr>");
            for group in self.columns.chunk_by(|a, b| a.group == b.group) {
                let (name, count) = (escape(&group[0].group), group.len());
                let _ = match name.is_empty() {
                    true => write!(html, "<td colspan=\"{count}\"></td>"),
                    false => {
                        write!(html, "<th scope=\"colgroup\" colspan=\"{count}\" class=\"group\">{name}</th>")
                    }
                };
            }
            html.push_str("</tr>\n");
        }
        html.push_str("<tr>");
        for (index, column) in self.columns.iter().enumerate() {
            let unit = match column.unit.is_empty() {
                true => String::new(),
                false => format!(" <span class=\"unit\">{}</span>", escape(&column.unit)),
            };
            let class = self.class(index);
            let _ = write!(html, "<th scope=\"col\"{class}>{}{unit}</th>", escape(&column.head));
        }
        html.push_str("</tr>\n</thead>\n<tbody>\n");
        let rows = self.columns.iter().map(|column| column.cells.len()).max().unwrap_or(0);
        for row in 0..rows {
            html.push_str("<tr>");
            for (index, column) in self.columns.iter().enumerate() {
                self.write_cell(&mut html, index, column.cells.get(row));
            }
            html.push_str("</tr>\n");
        }
        html.push_str("</tbody>\n</table></div>\n");
        html
    }

    fn write_cell(&self, html: &mut String, column: usize, cell: Option<&Cell>) {
        let value = match cell.and_then(|cell| cell.value) {
            Some(value) if value.is_infinite() => {
                format!(" data-value=\"{}Infinity\"", if value < 0.0 { "-" } else { "" })
            }
            Some(value) if !value.is_nan() => format!(" data-value=\"{value}\""),
            _ => String::new(),
        };
        let text = cell.map_or("", |cell| cell.html.as_str());
        let class = self.class(column);
        let _ = match column {
            0 => write!(html, "<th scope=\"row\"{class}{value}>{text}</th>"),
            _ => write!(html, "<td{class}{value}>{text}</td>"),
        };
    }

    /// The attribute that says how the cells of a column look.
    fn class(&self, index: usize) -> String {
        let column = &self.columns[index];
        let mut classes = match column.kind {
            Kind::Text => Vec::new(),
            Kind::Figures => vec!["figure"],
            Kind::Commands => vec!["command"],
        };
        let starts_group = index > 0 && column.group != self.columns[index - 1].group;
        if starts_group {
            classes.push("first");
        }
        match classes.is_empty() {
            true => String::new(),
            false => format!(" class=\"{}\"", classes.join(" ")),
        }
    }
}

/// The numbers that texts begin with, if all texts are numbers with the same unit after them, or nothing.
pub fn parse_figures(texts: &[&str]) -> Option<Vec<Option<f64>>> {
    let mut unit: Option<&str> = None;
    let mut values = Vec::with_capacity(texts.len());
    for text in texts.iter().map(|text| text.trim()) {
        if ["", "-", "–", "—"].contains(&text) {
            values.push(None);
            continue;
        }
        let is_of_number = |c: char| c.is_ascii_digit() || matches!(c, '.' | ',' | '-' | '−' | '+');
        let (number, rest) = text.split_at(text.find(|c| !is_of_number(c)).unwrap_or(text.len()));
        if *unit.get_or_insert(rest) != rest {
            return None;
        }
        values.push(Some(number.replace(',', "").replace('−', "-").parse().ok()?));
    }
    unit.map(|_| values)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_of_numbers_are_known() {
        assert_eq!(parse_figures(&["1,234", "–", "−0.5"]), Some(vec![Some(1234.0), None, Some(-0.5)]));
        assert_eq!(parse_figures(&["12.5 MiB", "3 MiB"]), Some(vec![Some(12.5), Some(3.0)]));
        assert_eq!(parse_figures(&["12 ms", "3 s"]), None);
        assert_eq!(parse_figures(&["bunny", "3"]), None);
        assert_eq!(parse_figures(&["", "–"]), None);
        assert_eq!(parse_figures(&["1.2.3"]), None);
    }

    #[test]
    fn columns_without_figures_are_left_out() {
        let table = Table::of([
            Column::of_html("<name>", [escape("a & b")]),
            Column::figures("none", "", [None]),
            Column::figures("some", "ms", [Some(12_345.0)]),
        ]);
        let html = table.to_html();
        assert!(!html.contains("none"));
        assert!(html.contains("&lt;name&gt;") && html.contains("a &amp; b"));
        assert!(html.contains("data-value=\"12345\">12,300</td>"));
    }
}
