//! The text of a scene file: what it says and where.

use super::error::{SceneFileError, SceneProblem};
use std::ops::Range;
use std::path::{Path, PathBuf};
use toml::Spanned;

/// A place in the text, in bytes.
pub(super) type Span = Range<usize>;

/// The file and its text.
#[derive(Debug, Clone)]
pub(super) struct Text {
    pub path: PathBuf,
    pub text: String,
}

impl Text {
    /// What is wrong at a place.
    pub fn error(&self, span: &Span, problem: SceneProblem) -> SceneFileError {
        let before = self.before(span);
        let column = before.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
        SceneFileError::At { path: self.path.clone(), line: self.line(span), column, problem }
    }

    /// The line of a place, counted from 1.
    pub fn line(&self, span: &Span) -> usize {
        self.before(span).matches('\n').count() + 1
    }

    /// A file that is named relative to the folder of this one.
    pub fn relative(&self, file: &str) -> PathBuf {
        self.path.parent().unwrap_or(Path::new("")).join(file)
    }

    fn before(&self, span: &Span) -> &str {
        self.text.get(..span.start).unwrap_or(&self.text)
    }
}

/// The keys that are given, in the order of the text.
pub(super) fn given<const N: usize>(keys: [(&'static str, Option<Span>); N]) -> Vec<(&'static str, Span)> {
    let mut given: Vec<_> = keys.into_iter().filter_map(|(key, span)| Some((key, span?))).collect();
    given.sort_by_key(|(_, span)| span.start);
    given
}

/// The value without its place.
pub(super) fn value<T: Copy>(spanned: Option<&Spanned<T>>) -> Option<T> {
    spanned.map(|spanned| *spanned.get_ref())
}
