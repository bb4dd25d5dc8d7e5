//! Progress on standard error, only where somebody watches.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressFinish, ProgressStyle};
use std::time::Duration;

/// A progress bar that is silent unless standard error is a terminal.
#[derive(Debug, Clone)]
pub struct Progress {
    bar: ProgressBar,
}

impl Progress {
    /// A bar over `total` units of work; `quiet` silences it.
    #[must_use]
    pub fn new(total: u64, quiet: bool) -> Self {
        // indicatif hides a bar by itself when standard error is not a terminal.
        let target = if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        // Clears itself when a failure drops it, so that the error has a line of its own.
        let bar = ProgressBar::with_draw_target(Some(total), target).with_finish(ProgressFinish::AndClear);
        let style = ProgressStyle::with_template(
            "{msg:12} [{bar:40}] {percent:>3} %  {elapsed} (left {eta}){prefix}",
        )
        .unwrap_or_else(|_| ProgressStyle::default_bar());
        bar.set_style(style.progress_chars("=> "));
        if !bar.is_hidden() {
            bar.enable_steady_tick(Duration::from_millis(200));
        }
        Self { bar }
    }

    /// A progress that shows nothing, for libraries' callers that do not watch.
    #[must_use]
    pub fn hidden() -> Self {
        Self { bar: ProgressBar::hidden() }
    }

    /// Names the stage at work and restarts the count over `total` units.
    pub fn stage(&self, name: &'static str, total: u64) {
        self.bar.set_message(name);
        self.bar.set_length(total);
        self.bar.set_position(0);
        self.bar.reset_eta();
    }

    /// Says something behind the bar, in place of what was said before.
    pub fn note(&self, text: String) {
        self.bar.set_prefix(text);
    }

    /// Counts `units` of work as done. Callable from any thread.
    pub fn add(&self, units: u64) {
        self.bar.inc(units);
    }

    /// Says something that stays above the bar, if somebody watches.
    pub fn say(&self, line: &str) {
        self.bar.println(line);
    }

    /// Removes the bar from the terminal.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
