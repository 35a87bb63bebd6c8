//! The progress of a bake: a bar on the standard error, with rate and time left.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use prt_bake::{Pass, Progress};

use crate::{cancel, output};

/// Shows passes as they run, and stops the bake on Ctrl-C. If the standard error is not a terminal, the log of a farm for example, it writes
/// a line now and then.
#[derive(Debug)]
pub(crate) struct BakeBar {
    bar: ProgressBar,
    rays: AtomicU64,
    /// Whether texels are counted, not vertices.
    counts_texels: AtomicBool,
    clock: Mutex<Clock>,
}

/// When things happened last.
#[derive(Debug)]
struct Clock {
    start: Instant,
    line: Instant,
}

/// Between two lines in a log.
const LINE_INTERVAL: Duration = Duration::from_secs(60);

impl BakeBar {
    pub(crate) fn new() -> Self {
        let now = Instant::now();
        let clock = Mutex::new(Clock { start: now, line: now });
        Self { bar: ProgressBar::new(0), rays: AtomicU64::new(0), counts_texels: AtomicBool::new(false), clock }
    }

    pub(crate) fn finish(&self) {
        self.bar.finish_and_clear();
    }

    /// Million rays per second of this pass.
    fn rate(&self) -> f64 {
        let seconds = self.clock.lock().map_or(0.0, |clock| clock.start.elapsed().as_secs_f64());
        self.rays.load(Ordering::Relaxed) as f64 / seconds.max(1e-9) / 1e6
    }

    /// Writes a line if it is time for one.
    fn log(&self) {
        let is_time = self.clock.lock().is_ok_and(|mut clock| {
            let is_time = clock.line.elapsed() >= LINE_INTERVAL;
            if is_time {
                clock.line = Instant::now();
            }
            is_time
        });
        if is_time {
            output::note(self.line());
        }
    }

    /// The state of a pass in words: `shadows 43 % of 34,853 vertices, 31.2 Mrays/s, 12 seconds left`.
    fn line(&self) -> String {
        let (done, all) = (self.bar.position(), self.bar.length().unwrap_or(0).max(1));
        let percent = 100 * done / all;
        let (all, what) = (output::count(all), unit(self.counts_texels.load(Ordering::Relaxed)));
        let left = indicatif::HumanDuration(self.bar.eta());
        format!("{} {percent} % of {all} {what}, {:.1} Mrays/s, {left} left", self.bar.prefix(), self.rate())
    }
}

impl Progress for BakeBar {
    fn start(&self, pass: Pass, count: usize) {
        let name = match pass {
            Pass::Direct | Pass::Texels => "shadows".to_owned(),
            Pass::Bounce(number) => format!("bounce {number}"),
        };
        self.counts_texels.store(pass == Pass::Texels, Ordering::Relaxed);
        self.rays.store(0, Ordering::Relaxed);
        if let Ok(mut clock) = self.clock.lock() {
            clock.start = Instant::now();
        }
        self.bar.set_style(style(pass == Pass::Texels));
        self.bar.reset();
        self.bar.set_length(count as u64);
        self.bar.set_prefix(name);
        self.bar.set_message(String::new());
    }

    fn advance(&self, count: usize, rays: u64) {
        let has_rays = self.rays.fetch_add(rays, Ordering::Relaxed) + rays > 0;
        self.bar.inc(count as u64);
        if self.bar.is_hidden() {
            self.log();
        } else if has_rays {
            self.bar.set_message(format!(", {:.1} Mrays/s", self.rate()));
        }
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
        bar.set_style(style(false));
        Self(bar)
    }

    pub(crate) fn advance(&self, points: usize) {
        self.0.inc(points as u64);
    }

    pub(crate) fn finish(&self) {
        self.0.finish_and_clear();
    }
}

fn unit(counts_texels: bool) -> &'static str {
    if counts_texels { "texels" } else { "vertices" }
}

fn style(counts_texels: bool) -> ProgressStyle {
    ProgressStyle::with_template(&template(counts_texels)).unwrap_or_else(|_| ProgressStyle::default_bar())
}

fn template(counts_texels: bool) -> String {
    let what = unit(counts_texels);
    format!("{{prefix:>9}} {{bar:32}} {{percent:>3}}% of {{human_len}} {what}{{msg}}, {{eta}} left")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_templates_are_valid() {
        assert!([false, true].map(template).iter().all(|template| ProgressStyle::with_template(template).is_ok()));
    }

    #[test]
    fn rays_of_a_pass_are_counted_from_its_start() {
        let bar = BakeBar::new();
        bar.start(Pass::Direct, 10);
        bar.advance(4, 1000);
        assert!(bar.rate() > 0.0);
        assert!(bar.line().starts_with("shadows 40 % of 10 vertices, "), "{}", bar.line());
        bar.start(Pass::Bounce(1), 10);
        bar.advance(10, 0);
        assert_eq!(bar.rate(), 0.0);
        bar.start(Pass::Texels, 20);
        bar.advance(1, 10);
        assert!(bar.line().starts_with("shadows 5 % of 20 texels, "), "{}", bar.line());
    }
}
