//! Pictures within the page.

use super::super::front::Reference;
use super::super::record::Setting;
use super::escape::escape;
use super::number::{duration, figure};
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use std::fmt::Write;
use std::path::Path;

/// A knob shows no more settings than this.
const MOST: usize = 8;

/// What every PNG file begins with (PNG specification, third edition, 5.2).
const SIGNATURE: [u8; 8] = *b"\x89PNG\r\n\x1a\n";

/// A picture as an element of the page, with the bytes of its file in it. A file that cannot be read is
/// named in its place, for a report is worth having without it.
pub fn embed(folder: &Path, name: &str, description: &str) -> String {
    match std::fs::read(folder.join(name)) {
        Ok(bytes) if bytes.starts_with(&SIGNATURE) => format!(
            "<img alt=\"{}\" decoding=\"async\" src=\"data:image/png;base64,{}\" />",
            escape(description),
            BASE64_STANDARD.encode(bytes)
        ),
        Ok(_) => missing(name, "is no PNG file"),
        Err(error) => missing(name, &error.to_string()),
    }
}

fn missing(name: &str, reason: &str) -> String {
    format!("<span class=\"missing\">{}: {}</span>", escape(name), escape(reason))
}

/// The pictures of some settings of a knob, each beside how it differs. Empty if there are none.
pub fn gallery(folder: &Path, settings: &[&Setting], reference: Reference) -> String {
    let mut html = String::new();
    for setting in choose(settings) {
        html.push_str("<figure class=\"pair\">\n");
        let pictures = [
            (&setting.picture, setting.label.clone()),
            (&setting.difference, format!("difference of {}", setting.label)),
        ];
        for (name, description) in pictures {
            if let Some(name) = name {
                let _ = writeln!(html, "{}", embed(folder, name, &description));
            }
        }
        let _ = writeln!(html, "<figcaption>{}</figcaption>\n</figure>", caption(setting, reference));
    }
    match html.is_empty() {
        true => html,
        false => format!("<div class=\"gallery\">\n{html}</div>\n"),
    }
}

fn caption(setting: &Setting, reference: Reference) -> String {
    let mut caption = format!(
        "<strong>{}</strong>{}<br />{}",
        escape(&setting.label),
        badges(setting),
        duration(setting.cost.seconds.median)
    );
    if let Some(errors) = reference.errors(setting) {
        let _ = write!(caption, ", FLIP {} against {}", figure(errors.flip), reference.name());
    }
    caption
}

/// What a setting is besides, after its name.
pub fn badges(setting: &Setting) -> String {
    let badge = |text: &str| format!(" <span class=\"badge\">{text}</span>");
    let default = if setting.is_default { badge("default") } else { String::new() };
    let exact = if setting.is_exact { badge("exact") } else { String::new() };
    default + &exact
}

/// Up to [`MOST`] settings that have a picture, in their order: both ends, the default and the exact one,
/// and others evenly from between.
fn choose<'a>(settings: &[&'a Setting]) -> Vec<&'a Setting> {
    let shown: Vec<&Setting> = settings
        .iter()
        .copied()
        .filter(|setting| setting.picture.is_some() || setting.difference.is_some())
        .collect();
    let Some(last) = shown.len().checked_sub(1) else { return Vec::new() };
    if shown.len() <= MOST {
        return shown;
    }
    let marked = (0..=last).filter(|&index| shown[index].is_default || shown[index].is_exact);
    let mut chosen: Vec<usize> = [0, last].into_iter().chain(marked).collect();
    chosen.sort_unstable();
    chosen.dedup();
    // The middle of the widest gap, until there are enough.
    while chosen.len() < MOST {
        let Some(gap) = chosen.windows(2).max_by_key(|gap| gap[1] - gap[0]) else { break };
        chosen.push((gap[0] + gap[1]) / 2);
        chosen.sort_unstable();
        chosen.dedup();
    }
    chosen.truncate(MOST);
    chosen.into_iter().map(|index| shown[index]).collect()
}

#[cfg(test)]
mod tests {
    use super::super::sample::setting;
    use super::*;

    #[test]
    fn the_default_the_exact_one_and_both_ends_are_shown() {
        let mut settings: Vec<Setting> = (0..30).map(|index| setting("lod", f64::from(index))).collect();
        settings[17].is_default = true;
        settings[28].is_exact = true;
        settings[3].picture = None;
        settings[3].difference = None;
        let places: Vec<f64> =
            choose(&settings.iter().collect::<Vec<_>>()).iter().map(|setting| setting.place).collect();
        assert_eq!(places.len(), MOST);
        assert!(places.is_sorted());
        assert!([0.0, 17.0, 28.0, 29.0].iter().all(|place| places.contains(place)), "{places:?}");
        assert!(places.windows(2).all(|pair| pair[1] - pair[0] <= 6.0), "{places:?}");
        assert_eq!(choose(&settings.iter().skip(3).take(1).collect::<Vec<_>>()).len(), 0);
    }

    #[test]
    fn a_file_that_is_no_picture_is_named() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a&b.png"), "text").unwrap();
        assert!(embed(folder.path(), "a&b.png", "").contains("a&amp;b.png: is no PNG file"));
        assert!(embed(folder.path(), "none.png", "").contains("none.png: "));
    }
}
