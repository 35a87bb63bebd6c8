//! The progress of a bake: a bar on the standard error, with rate and time left.

use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use indicatif::{ProgressBar, ProgressStyle};
use prt_bake::{Pass, Progress};

use crate::cancel;

/// Shows passes as they run, and stops the bake on Ctrl-C. Draws nothing if the standard error is not a terminal.
#[derive(Debug)]
pub(crate) struct BakeBar {
    bar: ProgressBar,
    rays: AtomicU64,
    start: Mutex<Instant>,
}

impl BakeBar {
    pub(crate) fn new() -> Self {
        Self { bar: ProgressBar::new(0), rays: AtomicU64::new(0), start: Mutex::new(Instant::now()) }
    }

    pub(crate) fn finish(&self) {
        self.bar.finish_and_clear();
    }

    /// Million rays per second of this pass.
    fn rate(&self) -> f64 {
        let seconds = self.start.lock().map_or(0.0, |start| start.elapsed().as_secs_f64());
        self.rays.load(Ordering::Relaxed) as f64 / seconds.max(1e-9) / 1e6
    }
}

impl Progress for BakeBar {
    fn start(&self, pass: Pass, vertex_count: usize) {
        let name = match pass {
            Pass::Direct => "shadows".to_owned(),
            Pass::Bounce(number) => format!("bounce {number}"),
        };
        self.rays.store(0, Ordering::Relaxed);
        if let Ok(mut start) = self.start.lock() {
            *start = Instant::now();
        }
        self.bar.set_style(style());
        self.bar.reset();
        self.bar.set_length(vertex_count as u64);
        self.bar.set_prefix(name);
        self.bar.set_message(String::new());
    }

    fn advance(&self, vertices: usize, rays: u64) {
        if self.rays.fetch_add(rays, Ordering::Relaxed) + rays > 0 && !self.bar.is_hidden() {
            self.bar.set_message(format!(", {:.1} Mrays/s", self.rate()));
        }
        self.bar.inc(vertices as u64);
    }

    fn is_cancelled(&self) -> bool {
        cancel::is_cancelled()
    }
}

/// Shows the progress of a fit. Draws nothing if the standard error is not a terminal.
#[derive(Debug)]
pub(crate) struct FitBar(ProgressBar);

impl FitBar {
    pub(crate) fn new(points: usize) -> Self {
        let bar = ProgressBar::new(points as u64).with_prefix("lobes");
        bar.set_style(style());
        Self(bar)
    }

    pub(crate) fn advance(&self, points: usize) {
        self.0.inc(points as u64);
    }

    pub(crate) fn finish(&self) {
        self.0.finish_and_clear();
    }
}

fn style() -> ProgressStyle {
    let template = "{prefix:>9} {bar:32} {percent:>3}% of {human_len} vertices{msg}, {eta} left";
    ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_template_is_valid() {
        assert!(
            ProgressStyle::with_template("{prefix:>9} {bar:32} {percent:>3}% of {human_len} vertices{msg}, {eta} left")
                .is_ok()
        );
    }

    #[test]
    fn rays_of_a_pass_are_counted_from_its_start() {
        let bar = BakeBar::new();
        bar.start(Pass::Direct, 10);
        bar.advance(4, 1000);
        assert!(bar.rate() > 0.0);
        bar.start(Pass::Bounce(1), 10);
        bar.advance(10, 0);
        assert_eq!(bar.rate(), 0.0);
    }
}
