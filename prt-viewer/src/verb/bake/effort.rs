//! How much work a bake is given: orders, rays, an error or a time.

use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::Context;
use glam::{Quat, Vec3};
use prt_bake::{
    BakeOptions, BakeTarget, Mesh, OrderReport, Progress, Savings, TexelOptions, error_for_time,
    error_for_time_of_texels, file_info, journal_info, recommend_order,
};
use serde::Serialize;
use sh_core::Order;

use crate::lighting::{self, Lighting};
use crate::{arguments, output};

/// Rays of a vertex, where nothing says otherwise.
const RAYS: usize = 4096;
/// Most rays of a vertex that stops by its error: enough for errors of 1e-4.
const MOST_RAYS: usize = 65_536;

/// An order, or the one that the scene needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum OrderChoice {
    Fixed(Order),
    Auto,
}

#[derive(Debug, clap::Args)]
pub(super) struct Effort {
    /// Bands of spherical harmonics, 1 to 32: n² coefficients per vertex; or auto, as many as the scene needs
    #[arg(long, value_name = "N|auto", default_value = "6", value_parser = order_choice)]
    order: OrderChoice,
    /// With --order auto: the light that the order is to be enough for
    #[arg(long, value_name = "ENVIRONMENT")]
    light: Option<PathBuf>,
    /// Rays per vertex or texel, over the hemisphere; with --error or --time the most that one may use [default: 4096, or 65536]
    #[arg(long, value_name = "COUNT", value_parser = arguments::rays)]
    rays: Option<usize>,
    /// Stop at each vertex when its estimated error, relative to unshadowed transfer, is below this
    #[arg(long, value_name = "ERROR", value_parser = arguments::error, conflicts_with_all = ["time", "unshadowed"])]
    error: Option<f64>,
    /// Reach the least error in this time: 90s, 5m, 8h
    #[arg(long, value_name = "TIME", value_parser = arguments::duration, conflicts_with_all = ["unshadowed", "part", "update"])]
    time: Option<Duration>,
}

/// What was decided before the bake.
#[derive(Debug, Default, Serialize)]
pub(super) struct Decision {
    /// Error at which a vertex stops; `null` where all get the same rays.
    target_error: Option<f64>,
    /// Seconds that the bake was expected to take with it, if that is how it was found.
    expected_seconds: Option<f64>,
    /// Relative error of order 1, 2, ..., if the order was to be found.
    order_errors: Option<Vec<f64>>,
}

impl Effort {
    /// The order of what has no choice.
    pub(super) fn fixed_order(&self) -> anyhow::Result<Order> {
        match self.order {
            OrderChoice::Fixed(order) => Ok(order),
            OrderChoice::Auto => Err(output::usage("--order auto is for meshes; the scene is a height field")),
        }
    }

    /// Rays of what has no error to stop at.
    pub(super) fn fixed_rays(&self) -> anyhow::Result<usize> {
        if self.error.is_some() || self.time.is_some() {
            return Err(output::usage("--error and --time are for meshes; the scene is a height field"));
        }
        Ok(self.rays.unwrap_or(RAYS))
    }

    /// The options before anything is decided.
    pub(super) fn options(&self, defaults: &BakeOptions) -> BakeOptions {
        let fallback = if self.error.is_some() || self.time.is_some() { MOST_RAYS } else { RAYS };
        let order = match self.order {
            OrderChoice::Fixed(order) => order,
            OrderChoice::Auto => defaults.order,
        };
        BakeOptions {
            order,
            rays_per_vertex: self.rays.unwrap_or(fallback),
            target_error: self.error,
            ..defaults.clone()
        }
    }

    /// Decides the order and the error for a mesh, or for its texels.
    pub(super) fn decide(
        &self,
        mesh: &Mesh,
        texels: Option<&TexelOptions>,
        target: &BakeTarget,
        options: &mut BakeOptions,
        progress: &dyn Progress,
    ) -> anyhow::Result<Decision> {
        let mut decision = Decision::default();
        if self.order == OrderChoice::Auto {
            let found = recommend_order(mesh, options, self.light()?.as_deref(), None)?;
            output::note(recommendation(&found));
            options.order = found.order;
            decision.order_errors = Some(found.errors);
        }
        if let Some(time) = self.time {
            match error_of_earlier(target) {
                Some(error) => options.target_error = Some(error),
                None => {
                    let plan = match texels {
                        Some(texels) => error_for_time_of_texels(mesh, options, texels, time, progress)?,
                        None => error_for_time(mesh, options, time, progress)?,
                    };
                    options.target_error = Some(plan.target_error);
                    decision.expected_seconds = Some((plan.expected + plan.pilot).as_secs_f64());
                }
            }
        }
        decision.target_error = options.target_error;
        Ok(decision)
    }

    /// Light vectors of the environment, as it stands in a scene with y up.
    fn light(&self) -> anyhow::Result<Option<Vec<f32>>> {
        let Some(path) = &self.light else { return Ok(None) };
        let order = Order::new(OrderReport::PILOT_ORDER).context("the order of the pilot")?;
        let lighting = Lighting::load(Path::new(path), order)?;
        Ok(Some(lighting.light(order, lighting::upright(Vec3::Y) * Quat::IDENTITY)))
    }
}

/// The error that a bake which is resumed was begun with, or was finished with: its time is not measured again. What was made from another
/// file does not count.
fn error_of_earlier(target: &BakeTarget) -> Option<f64> {
    if target.unfinished != prt_bake::Unfinished::Resume {
        return None;
    }
    if let Ok(journal) = journal_info(&target.journal_path()) {
        return journal.settings.get("target_error")?.parse().ok();
    }
    let done = file_info(&target.path).ok()?.metadata;
    let source = target.source.as_ref()?;
    let is_of_source = done.get("source").is_some_and(|from| from.ends_with(&source.sha256));
    done.get("target_error").filter(|_| is_of_source)?.parse().ok()
}

/// An order in digits, or `auto`.
fn order_choice(text: &str) -> Result<OrderChoice, String> {
    if text.eq_ignore_ascii_case("auto") {
        return Ok(OrderChoice::Auto);
    }
    arguments::order(text).map(OrderChoice::Fixed).map_err(|error| format!("{error}, or auto"))
}

/// What each order leaves out, and the one that is enough.
fn recommendation(found: &OrderReport) -> String {
    let shown = found.errors.iter().take((found.order.get() + 2).min(found.errors.len())).enumerate();
    let errors: Vec<String> = shown.map(|(n, error)| format!("{}: {:.1} %", n + 1, 100.0 * error)).collect();
    format!("order {} is enough here; error of order {}", found.order, errors.join(", "))
}

/// What was saved, in words; `None` where nothing was.
///
/// - `points`: vertices, or texels
pub(super) fn about_savings(savings: &Savings, points: &str) -> Option<String> {
    let open_points = output::count(savings.open_vertices as u64);
    let blocked = output::count(savings.blocked_vertices as u64);
    let factor = savings.fixed_directions as f64 / (savings.rays as f64).max(1.0);
    let open = format!("{open_points} {points} see the whole sky, {blocked} none of it");
    (savings.fixed_directions > 0).then(|| match factor > 1.05 {
        true => format!("{open}; {factor:.1} times fewer rays than {} for each", per_vertex(savings)),
        false => open,
    })
}

fn per_vertex(savings: &Savings) -> String {
    let vertices: usize = savings.levels.iter().map(|level| level.vertices).sum();
    output::count(savings.fixed_directions / (vertices as u64).max(1))
}
