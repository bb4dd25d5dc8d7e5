//! What has been measured already: a study that was stopped goes on from there.

use super::record::{Chapter, Knob, Setting};
use anyhow::{Context, bail};
use serde::{Deserialize, Serialize};
use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

/// The name of the file in the study's folder.
const FILE: &str = "results.jsonl";

/// A line of the file.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Line {
    /// The first: what the study is of. Results of another are of no use.
    Study(String),
    Setting(Box<Setting>),
    Chapter(Chapter),
    /// What the default picture took, each time that it was made.
    DefaultSeconds(Vec<f64>),
}

/// Results, in memory and, as soon as they are known, in a file, a line each.
pub struct Results {
    path: PathBuf,
    file: File,
    settings: Vec<Setting>,
    chapters: Vec<Chapter>,
    default_seconds: Vec<f64>,
}

impl Results {
    /// Those of a study in a folder, which is made if it is not there. `study` tells one study from another; if the folder
    /// has results of another, that is an error, unless they are to be forgotten.
    ///
    /// A last line that was not written to its end is left out.
    pub fn open(folder: &Path, study: &str, forget: bool) -> anyhow::Result<Self> {
        let named = || format!("{}: cannot make the folder of the study", folder.display());
        std::fs::create_dir_all(folder).with_context(named)?;
        let path = folder.join(FILE);
        let text = match std::fs::read_to_string(&path) {
            _ if forget => String::new(),
            Ok(text) => text,
            Err(error) if error.kind() == ErrorKind::NotFound => String::new(),
            Err(error) => {
                return Err(error).with_context(|| {
                    format!("{}: cannot be read; give another folder, or --anew", path.display())
                });
            }
        };
        let mut kept = 0;
        let mut lines = text.split_inclusive('\n').map_while(|line| {
            let found = serde_json::from_str::<Line>(line.strip_suffix('\n')?).ok()?;
            kept += line.len();
            Some(found)
        });
        let (mut settings, mut chapters) = (Vec::new(), Vec::new());
        match lines.next() {
            Some(Line::Study(found)) if found != study => bail!(
                "{}: has the results of another study ({found}); give another folder, or --anew to forget them",
                path.display()
            ),
            Some(Line::Study(_)) => {}
            _ if text.is_empty() => {}
            _ => bail!("{}: is not the results of a study; give another folder, or --anew", path.display()),
        }
        let mut default_seconds = Vec::new();
        for line in lines {
            match line {
                Line::Setting(setting) => settings.push(*setting),
                Line::Chapter(chapter) => chapters.push(chapter),
                Line::DefaultSeconds(seconds) => default_seconds.extend(seconds),
                Line::Study(_) => {}
            }
        }
        let cannot_write = || format!("{}: cannot be written", path.display());
        let file = OpenOptions::new().append(true).create(true).open(&path).with_context(cannot_write)?;
        file.set_len(kept as u64).with_context(cannot_write)?;
        let mut results = Self { path, file, settings, chapters, default_seconds };
        if kept == 0 {
            results.write(&Line::Study(study.into()))?;
        }
        Ok(results)
    }

    /// A setting that has been measured.
    pub fn find(&self, knob: &str, label: &str) -> Option<&Setting> {
        self.settings.iter().find(|setting| setting.knob == knob && setting.label == label)
    }

    /// A chapter that is done.
    pub fn chapter(&self, title: &str) -> Option<&Chapter> {
        self.chapters.iter().find(|chapter| chapter.title == title)
    }

    /// All settings of some knobs, those of each together in the order in which they were found; and all chapters.
    pub fn take(&mut self, knobs: &[Knob]) -> (Vec<Setting>, Vec<Chapter>) {
        let place = |setting: &Setting| knobs.iter().position(|knob| knob.name == setting.knob);
        let mut settings = std::mem::take(&mut self.settings);
        settings.retain(|setting| place(setting).is_some());
        settings.sort_by_key(place);
        (settings, std::mem::take(&mut self.chapters))
    }

    pub fn add(&mut self, setting: Setting) -> anyhow::Result<()> {
        let line = Line::Setting(Box::new(setting));
        self.write(&line)?;
        if let Line::Setting(setting) = line {
            self.settings.push(*setting);
        }
        Ok(())
    }

    pub fn add_chapter(&mut self, chapter: Chapter) -> anyhow::Result<()> {
        let line = Line::Chapter(chapter);
        self.write(&line)?;
        if let Line::Chapter(chapter) = line {
            self.chapters.push(chapter);
        }
        Ok(())
    }

    /// What the default picture took, each time that it was made.
    pub fn default_seconds(&self) -> &[f64] {
        &self.default_seconds
    }

    pub fn add_default_seconds(&mut self, seconds: Vec<f64>) -> anyhow::Result<()> {
        self.default_seconds.extend(&seconds);
        self.write(&Line::DefaultSeconds(seconds))
    }

    fn write(&mut self, line: &Line) -> anyhow::Result<()> {
        let mut text = serde_json::to_string(line)?;
        text.push('\n');
        let written = self.file.write_all(text.as_bytes()).and_then(|()| self.file.flush());
        written.with_context(|| format!("{}: cannot be written", self.path.display()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chapter(title: &str) -> Chapter {
        Chapter { title: title.into(), introduction: String::new(), tables: Vec::new() }
    }

    #[test]
    fn a_study_that_was_stopped_goes_on() {
        let folder = tempfile::tempdir().unwrap();
        let mut results = Results::open(folder.path(), "a", false).unwrap();
        results.add_chapter(chapter("one")).unwrap();
        results.add_chapter(chapter("two")).unwrap();
        drop(results);
        // The last line was being written.
        let path = folder.path().join(FILE);
        let text = std::fs::read_to_string(&path).unwrap();
        std::fs::write(&path, &text[..text.len() - 5]).unwrap();

        let mut results = Results::open(folder.path(), "a", false).unwrap();
        assert!(results.chapter("one").is_some() && results.chapter("two").is_none());
        results.add_chapter(chapter("three")).unwrap();
        drop(results);
        let results = Results::open(folder.path(), "a", false).unwrap();
        assert!(results.chapter("one").is_some() && results.chapter("three").is_some());
    }

    #[test]
    fn results_of_another_study_are_not_taken() {
        let folder = tempfile::tempdir().unwrap();
        Results::open(folder.path(), "a", false).unwrap().add_chapter(chapter("one")).unwrap();
        assert!(Results::open(folder.path(), "b", false).is_err());
        assert!(Results::open(folder.path(), "a", false).unwrap().chapter("one").is_some());
        assert!(Results::open(folder.path(), "b", true).unwrap().chapter("one").is_none());
        for other in [&b"anything\n"[..], b"\xff\xfe"] {
            std::fs::write(folder.path().join(FILE), other).unwrap();
            assert!(Results::open(folder.path(), "b", false).is_err());
            assert_eq!(std::fs::read(folder.path().join(FILE)).unwrap(), other);
        }
    }
}
