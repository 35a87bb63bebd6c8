//! The panel beside the picture.

use std::sync::Arc;

use eframe::egui::{self, Slider, Ui};
use prt_bake::BakedSurface;

use super::settings::{EXPOSURE, Settings};
use crate::lighting::Lighting;
use crate::output;
use crate::shading::Part;

/// Width of the panel at first, points.
pub(super) const WIDTH: f32 = 230.0;

/// What the panel tells beside the settings.
#[derive(Debug)]
pub(super) struct Facts<'a> {
    pub(super) baked: &'a BakedSurface,
    pub(super) lightings: &'a [Arc<Lighting>],
    pub(super) parts: &'a [Part],
    pub(super) adapter: &'a str,
    /// Seconds between frames, if frames follow one another.
    pub(super) frame_seconds: Option<f32>,
    /// Seconds of work for the last frame.
    pub(super) work_seconds: Option<f32>,
    pub(super) message: &'a str,
}

pub(super) fn show(ui: &mut Ui, settings: &mut Settings, facts: &Facts<'_>) {
    egui::ScrollArea::vertical().show(ui, |ui| {
        light(ui, settings, facts);
        ui.separator();
        paths(ui, settings, facts);
        ui.separator();
        transfer(ui, settings, facts);
        ui.separator();
        frame(ui, settings, facts);
        if !facts.message.is_empty() {
            ui.separator();
            ui.label(facts.message);
        }
    });
}

fn light(ui: &mut Ui, settings: &mut Settings, facts: &Facts<'_>) {
    ui.heading("Light");
    for (index, lighting) in facts.lightings.iter().enumerate() {
        ui.radio_value(&mut settings.environment, index, &lighting.name);
    }
    ui.checkbox(&mut settings.shows_environment, "In the background");
    ui.add(Slider::new(&mut settings.exposure, EXPOSURE).step_by(0.1).text("Exposure"));
    let order = facts.baked.transfer.order.get();
    ui.add(Slider::new(&mut settings.order, 1..=order).text("Order"));
}

fn paths(ui: &mut Ui, settings: &mut Settings, facts: &Facts<'_>) {
    ui.heading("Light paths");
    for part in [Part::Unshadowed, Part::Shadowed, Part::Full] {
        let name = match part {
            Part::Unshadowed => "Unshadowed",
            Part::Shadowed => "Shadowed",
            Part::Full => "Interreflected",
        };
        let is_there = facts.parts.contains(&part);
        let button = egui::RadioButton::new(settings.part == part, name);
        let response = ui.add_enabled(is_there, button).on_disabled_hover_text("not in this file");
        if response.clicked() {
            settings.part = part;
        }
    }
}

fn transfer(ui: &mut Ui, settings: &mut Settings, facts: &Facts<'_>) {
    ui.heading("Transfer");
    ui.checkbox(&mut settings.shows_transfer, "Show a coefficient");
    let count = facts.baked.transfer.order.coeff_count();
    ui.add_enabled(settings.shows_transfer, Slider::new(&mut settings.coefficient, 0..=count - 1).text("i"));
    let (l, m) = settings.band();
    ui.weak(format!("band {l}, m = {m}: orange +, blue -"));
}

fn frame(ui: &mut Ui, settings: &mut Settings, facts: &Facts<'_>) {
    let BakedSurface { geometry, metadata, transfer, .. } = facts.baked;
    ui.heading("Frame");
    ui.checkbox(&mut settings.draws_continuously, "Draw all the time");
    ui.label(match facts.frame_seconds {
        Some(seconds) => format!("{:.1} ms a frame, {:.0} a second", 1e3 * seconds, 1.0 / seconds.max(1e-6)),
        None => facts.work_seconds.map_or(String::new(), |seconds| format!("{:.1} ms of CPU work", 1e3 * seconds)),
    });
    ui.label(format!("{} vertices", output::count(geometry.vertex_count() as u64)));
    ui.label(format!("{} triangles", output::count(geometry.triangles.len() as u64)));
    ui.label(format!(
        "order {}, {} rays, {} bounces",
        transfer.order,
        output::count(metadata.rays as u64),
        metadata.bounces
    ));
    ui.label(facts.adapter);
    ui.checkbox(&mut settings.shows_help, "Mouse and keys");
}
