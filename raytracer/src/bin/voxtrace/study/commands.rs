//! The commands that repeat a study and each of its settings.

use super::knobs::{Base, Choice, Primary, Work};
use super::subject::{Conversion, Normals};
use octvox_converter::{LodColor, Options};
use octvox_raytracer::{Arithmetic, Quality};

/// What all commands of a study have in common.
pub struct Commands<'a> {
    /// The model or scene.
    pub model: String,
    /// The camera's options, if some were given, with a blank before each.
    pub view: String,
    /// Columns and rows.
    pub size: [u32; 2],
    /// The frame of a scene; nothing for a model.
    pub frame: Option<u32>,
    /// What the subject asks for by itself.
    pub quality: Quality,
    pub base: &'a Base,
}

impl Commands<'_> {
    /// The command that shows what a setting shows.
    pub fn of(&self, choice: &Choice) -> String {
        let [width, height] = self.size;
        let size = format!(" --size {width}x{height}");
        let frame = self.frame.map_or_else(String::new, |frame| format!(" --frames {frame}"));
        let (before, model, after) = self.converted(&choice.conversion);
        match choice.work {
            Work::Picture => {
                let quality = self.quality_options(&choice.quality);
                let view = &self.view;
                format!("{before}voxtrace render {model} -o picture.png{size}{frame}{view}{quality}{after}")
            }
            Work::Primary(primary) => {
                format!(
                    "{before}voxtrace bench {model}{size}{}{}{after}",
                    self.view,
                    primary_options(&primary)
                )
            }
            Work::Exact => {
                format!("{before}voxtrace check {model} --arithmetic {}{after}", Arithmetic::Double.name())
            }
        }
    }

    /// What comes before the program, the model with its resolution, and what is to be said at the end.
    fn converted(&self, conversion: &Conversion) -> (String, String, String) {
        let model = quoted(&self.model);
        let nothing = String::new;
        let Some([_, deepest]) = self.base.depths else { return (nothing(), model, nothing()) };
        let Conversion { levels, palette_size, normals, lod_color } = *conversion;
        let resolution = 1u32 << deepest.saturating_add_signed(levels).min(Options::MAX_DEPTH);
        let others = conversion_options(palette_size, normals, lod_color);
        if self.frame.is_some() {
            let mut remarks = Vec::new();
            if levels != 0 {
                remarks
                    .push(format!("the finest model at {resolution}³, the others as much coarser or finer"));
            }
            if !others.is_empty() {
                remarks.push(format!("models by `obj2vox{others}`"));
            }
            let remark = if remarks.is_empty() { nothing() } else { format!("  # {}", remarks.join("; ")) };
            return (nothing(), model, remark);
        }
        if others.is_empty() {
            return (nothing(), format!("{model} -r {resolution}"), nothing());
        }
        let remark = if normals == Normals::Faces { "  # of a mesh without normals" } else { "" };
        let before = format!("obj2vox {model} -r {resolution} -o model.vox{others} && ");
        (before, "model.vox".into(), remark.into())
    }

    /// What the command line says of a quality that is not the subject's own.
    fn quality_options(&self, quality: &Quality) -> String {
        let own = &self.quality;
        let mut options = String::new();
        let mut add = |is_other: bool, option: String| {
            if is_other {
                options += &option;
            }
        };
        add(quality.samples != own.samples, format!(" --samples {}", quality.samples));
        // More rays where pixels differ are given up by the command line only if the subject has none.
        let is_uniform = own.most_samples == own.samples;
        let most = if is_uniform { quality.samples } else { own.most_samples.max(quality.samples) };
        add(quality.most_samples != most, format!(" --most-samples {}", quality.most_samples));
        add(
            quality.most_samples > quality.samples && quality.contrast != own.contrast,
            format!(" --contrast {}", quality.contrast),
        );
        let follows = own.lod_pixels == own.lod_of_its_rays();
        let lod_pixels = if follows { quality.lod_of_its_rays() } else { own.lod_pixels };
        add(quality.lod_pixels != lod_pixels, format!(" --lod {}", quality.lod_pixels));
        add(quality.filter != own.filter, format!(" --filter {}", quality.filter.name()));
        add(quality.leave != own.leave, format!(" --leave {}", quality.leave.name()));
        add(quality.smooth_pixels != own.smooth_pixels, format!(" --smooth {}", quality.smooth_pixels));
        add(quality.arithmetic != own.arithmetic, format!(" --arithmetic {}", quality.arithmetic.name()));
        add(
            quality.light_samples != own.light_samples,
            format!(" --light-samples {}", quality.light_samples),
        );
        add(
            quality.ambient_samples != own.ambient_samples,
            format!(" --ambient-samples {}", quality.ambient_samples),
        );
        add(quality.bounces != own.bounces, format!(" --bounces {}", quality.bounces));
        add(quality.cutoff != own.cutoff, format!(" --cutoff {}", quality.cutoff));
        options
    }
}

/// What the converter is told, but for the resolution; nothing for what `voxtrace` does with a mesh by itself.
fn conversion_options(palette_size: usize, normals: Normals, lod_color: LodColor) -> String {
    let default = Conversion::default();
    if (palette_size, normals, lod_color) == (default.palette_size, default.normals, default.lod_color) {
        return String::new();
    }
    let mut options = String::from(if normals == Normals::Spherical { " --format 4" } else { " --format 5" });
    if palette_size != default.palette_size {
        options += &format!(" --palette {palette_size}");
    }
    if lod_color == LodColor::Majority {
        options += " --lod-color majority";
    }
    if normals == Normals::Faces {
        options += " --crease 0";
    }
    options
}

fn primary_options(primary: &Primary) -> String {
    format!(
        " --arithmetic {} --lanes {} --beams {} --grid {} --lod 0",
        primary.arithmetic.name(),
        primary.width.lanes(),
        if primary.beams { "on" } else { "off" },
        if primary.grid == 0 { 0 } else { 1u32 << primary.grid },
    )
}

/// The command of this process, but for what it shows and whether it begins anew.
pub fn this_command() -> String {
    let is_of_study = |argument: &String| !["--anew", "--json", "--quiet"].contains(&argument.as_str());
    let arguments = std::env::args_os().skip(1).map(|argument| argument.to_string_lossy().into_owned());
    let arguments: Vec<String> = arguments.filter(is_of_study).map(|argument| quoted(&argument)).collect();
    format!("voxtrace {}", arguments.join(" "))
}

/// An argument as a shell reads it.
fn quoted(argument: &str) -> String {
    let is_plain = |letter: char| letter.is_alphanumeric() || "-_./,=:+%@".contains(letter);
    if !argument.is_empty() && argument.chars().all(is_plain) {
        return argument.to_owned();
    }
    format!("'{}'", argument.replace('\'', "'\\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arguments_are_quoted_where_a_shell_would_take_them_apart() {
        assert_eq!(quoted("models/bunny-1.obj"), "models/bunny-1.obj");
        assert_eq!(quoted("my bunny.obj"), "'my bunny.obj'");
        assert_eq!(quoted("it's"), "'it'\\''s'");
        assert_eq!(quoted(""), "''");
    }
}
