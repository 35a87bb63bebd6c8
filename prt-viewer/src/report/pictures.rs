//! The pictures of a report.

use prt_bake::VertexStats;
use prt_gpu::{Surface, cpu};
use sh_core::Order;

use super::ReportInput;
use super::base64::encode;
use super::color::{Ramp, Scale, encode_srgb, false_color};
use super::findings::{ErrorSpread, Findings, Open};
use super::legend::{Legend, Unit, css};
use super::marks::{self, Mark};
use super::raster::{BACK, Canvas, Raster};
use super::stage::Stage;
use crate::lighting::Lighting;
use crate::sky::BuiltIn;
use crate::{output, picture};

/// Linear colour of the surface below marks, where it faces the eye.
const CLAY: f32 = 0.42;
/// False colours keep this share of their brightness where the surface turns away from the eye: enough to see its shape, little enough to
/// tell the colour.
const EDGE: f32 = 0.55;
/// Stops by which the lit picture is brighter than what suits a picture with a background.
const BRIGHTER: f32 = 0.6;

const ERROR_MEANING: &str =
    "Expected error of a vertex's transfer, relative to what it would be without shadows. The scale is logarithmic.";
const INVALID_MEANING: &str = "Most of what these vertices see is the backs of faces, so they lie inside something solid and get no \
                               light that could be trusted. Rings lie behind what is in front of them.";
/// Share of the vertices whose error must be known to draw it as a surface.
const DENSE: f32 = 0.5;

/// All pictures; none if there is nothing that could be shown.
#[derive(Debug, Default)]
pub(super) struct Pictures {
    pub(super) title: Option<Picture>,
    pub(super) panels: Vec<Panel>,
    /// Share of what is seen that is backs of faces, over all views.
    pub(super) back_share: f64,
    /// What could not be drawn, and why.
    pub(super) problem: Option<String>,
}

/// The same quantity from some sides.
#[derive(Debug)]
pub(super) struct Panel {
    pub(super) name: &'static str,
    pub(super) heading: &'static str,
    pub(super) explanation: String,
    pub(super) legend: Legend,
    pub(super) pictures: Vec<Picture>,
}

#[derive(Debug)]
pub(super) struct Picture {
    pub(super) side: &'static str,
    /// A PNG, as base64.
    pub(super) data: String,
}

impl Picture {
    fn of(side: &'static str, raster: &Raster) -> anyhow::Result<Self> {
        Ok(Self { side, data: encode(&raster.png()?) })
    }
}

/// Draws everything there is to see. What cannot be drawn is said, never a failure: the bake is worth more than its pictures.
pub(super) fn draw(input: &ReportInput<'_>, findings: &Findings) -> Pictures {
    let Some(stage) = Stage::new(&input.baked.geometry) else {
        let problem = "There are no pictures: the surface has no extent that a camera could frame.".to_owned();
        return Pictures { problem: Some(problem), ..Pictures::default() };
    };
    draw_stage(input, findings, &stage).unwrap_or_else(|error| Pictures {
        problem: Some(format!("There are no pictures: {error:#}.")),
        ..Pictures::default()
    })
}

fn draw_stage(input: &ReportInput<'_>, findings: &Findings, stage: &Stage<'_>) -> anyhow::Result<Pictures> {
    let canvases: Vec<Canvas<'_>> = stage.shots.iter().map(|shot| Canvas::new(stage, shot)).collect();
    let back_share = canvases.iter().map(Canvas::back_share).sum::<f64>() / canvases.len() as f64;
    let mut panels = vec![occlusion(findings).draw(&canvases)?];
    match (error(input, findings), &findings.error) {
        (Some(plan), _) => panels.push(plan.draw(&canvases)?),
        (None, Some(_)) => panels.push(error_samples(input, stage, &canvases)?),
        (None, None) => {}
    }
    if !findings.invalid.is_empty() {
        panels.push(invalid(findings, stage, &canvases)?);
    }
    if let Some(plan) = rays(input, findings) {
        panels.push(plan.draw(&canvases)?);
    }
    if back_share > 0.01 {
        panels.iter_mut().for_each(|panel| panel.legend.keys.push(Legend::backs()));
    }
    let (title, problem) = match lit(input, stage) {
        Ok(title) => (Some(title), None),
        Err(error) => (None, Some(format!("The lit picture is missing: {error:#}."))),
    };
    Ok(Pictures { title, panels, back_share, problem })
}

/// The surface under the environment that `render` takes by default.
fn lit(input: &ReportInput<'_>, stage: &Stage<'_>) -> anyhow::Result<Picture> {
    let (transfer, geometry) = (&input.baked.transfer, stage.geometry);
    let order: Order = transfer.order;
    let surface = Surface::new(
        &stage.positions,
        &geometry.triangles,
        &geometry.albedo,
        order,
        transfer.channels,
        &transfer.values,
    )?;
    let light = Lighting::built_in(BuiltIn::Sky, order).light(order, glam::Quat::IDENTITY);
    let frame = cpu::render(&surface, &light, order, &stage.title.view)?;
    let stops = picture::automatic_exposure(&frame) + BRIGHTER;
    let display = |x: f32| (255.0 * prt_gpu::tone_map([x; 3], stops)[0]).round() as u8;
    Picture::of(
        stage.title.name,
        &Canvas::new(stage, &stage.title).develop(&frame, BACK.map(|channel| channel * (-stops).exp2()), display),
    )
}

/// What is drawn in false colours: one value for each vertex.
struct Plan {
    panel: Panel,
    /// `[V]`, linear.
    colors: Vec<[f32; 3]>,
    /// Share of the brightness that is kept at edges.
    edge: f32,
}

impl Plan {
    fn draw(mut self, canvases: &[Canvas<'_>]) -> anyhow::Result<Panel> {
        for canvas in canvases {
            let shade = |(color, facing): (&[f32; 3], f32)| {
                let brightness = self.edge + (1.0 - self.edge) * facing;
                color.map(|channel| brightness * channel)
            };
            let colors: Vec<[f32; 3]> = self.colors.iter().zip(canvas.facing()).map(shade).collect();
            self.panel.pictures.push(Picture::of(canvas.shot.name, &canvas.paint(&colors))?);
        }
        Ok(self.panel)
    }
}

fn occlusion(findings: &Findings) -> Plan {
    let scale = Scale::Linear { low: 0.0, high: 1.0 };
    let share = match &findings.open {
        Open::Direct(_) => "Share of the light that reaches each vertex directly when it comes evenly from everywhere",
        Open::Directions(_) => "Share of the directions above each vertex that meet nothing",
        Open::Total(_) => {
            "Share of the light that reaches each vertex, reflected light too, when it comes evenly from everywhere"
        }
    };
    Plan {
        colors: findings.open.shares().iter().map(|&share| false_color(Ramp::Light, scale, share)).collect(),
        edge: 1.0,
        panel: Panel {
            name: "occlusion",
            heading: "Occlusion",
            explanation: format!("{share}: white is open, black is hidden."),
            legend: Legend::of(Ramp::Light, scale, Unit::Percent),
            pictures: Vec::new(),
        },
    }
}

fn error(input: &ReportInput<'_>, findings: &Findings) -> Option<Plan> {
    let is_dense = |spread: &&ErrorSpread| spread.estimated as f32 >= DENSE * input.vertices.len() as f32;
    let spread = findings.error.as_ref().filter(is_dense)?;
    let errors = || input.vertices.iter().map(|stats| stats.error);
    let scale = Scale::decades_around(errors());
    let legend = Legend::of(Ramp::Heat, scale, Unit::Percent);
    let all = spread.estimated == input.vertices.len();
    Some(Plan {
        colors: errors().map(|error| false_color(Ramp::Heat, scale, error)).collect(),
        edge: EDGE,
        panel: Panel {
            name: "error",
            heading: "Estimated error",
            explanation: ERROR_MEANING.to_owned(),
            legend: if all { legend } else { legend.with_missing("not estimated") },
            pictures: Vec::new(),
        },
    })
}

fn rays(input: &ReportInput<'_>, findings: &Findings) -> Option<Plan> {
    let spread = findings.rays.as_ref().filter(|spread| spread.vary())?;
    let scale = Scale::Linear { low: f64::from(spread.fewest), high: f64::from(spread.most) };
    let colors = input.vertices.iter().map(|stats| false_color(Ramp::Work, scale, stats.rays as f32));
    Some(Plan {
        colors: colors.collect(),
        edge: EDGE,
        panel: Panel {
            name: "rays",
            heading: "Rays for each vertex",
            explanation:
                "Rays that were traced one by one: few where the sky is open or wholly hidden, many where shadows are \
                          intricate."
                    .to_owned(),
            legend: Legend::of(Ramp::Work, scale, Unit::Count),
            pictures: Vec::new(),
        },
    })
}

/// Dots in false colours, where the error of few vertices was estimated.
fn error_samples(input: &ReportInput<'_>, stage: &Stage<'_>, canvases: &[Canvas<'_>]) -> anyhow::Result<Panel> {
    let scale = Scale::decades_around(input.vertices.iter().map(|stats| stats.error));
    let samples = input.vertices.iter().zip(&stage.positions).filter(|(stats, _)| !stats.error.is_nan());
    let mark = |(stats, &position): (&VertexStats, &[f32; 3])| {
        let color = false_color(Ramp::Heat, scale, stats.error).map(encode_srgb);
        Mark { position, color }
    };
    let marks: Vec<Mark> = samples.map(mark).collect();
    Ok(Panel {
        name: "error",
        heading: "Estimated error",
        explanation: format!("{ERROR_MEANING} It was estimated at {} vertices.", output::count(marks.len() as u64)),
        legend: Legend::of(Ramp::Heat, scale, Unit::Percent),
        pictures: marked(&marks, canvases)?,
    })
}

fn invalid(findings: &Findings, stage: &Stage<'_>, canvases: &[Canvas<'_>]) -> anyhow::Result<Panel> {
    let mark = |&vertex: &u32| Mark { position: stage.positions[vertex as usize], color: marks::DOT };
    let [r, g, b] = marks::DOT;
    let dot = format!("rgb({r},{g},{b})");
    Ok(Panel {
        name: "invalid",
        heading: "Vertices inside geometry",
        explanation: INVALID_MEANING.to_owned(),
        legend: Legend { bar: None, keys: vec![(dot, "inside geometry"), (css([CLAY; 3]), "all other vertices")] },
        pictures: marked(&findings.invalid.iter().map(mark).collect::<Vec<_>>(), canvases)?,
    })
}

/// Marks on a surface of clay, from all sides.
fn marked(marks: &[Mark], canvases: &[Canvas<'_>]) -> anyhow::Result<Vec<Picture>> {
    let from = |canvas: &Canvas<'_>| {
        let clay: Vec<[f32; 3]> = canvas.facing().map(|facing| [CLAY * (EDGE + (1.0 - EDGE) * facing); 3]).collect();
        let mut raster = canvas.paint(&clay);
        marks::mark(&mut raster, canvas, marks);
        Picture::of(canvas.shot.name, &raster)
    };
    canvases.iter().map(from).collect()
}
