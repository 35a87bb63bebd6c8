//! The panel beside the picture.

use std::sync::Arc;

use eframe::egui::{self, Slider, Ui};

use super::settings::{EXPOSURE, Settings};
use crate::lighting::Lighting;
use crate::model::Model;
use crate::motion::{Actor, Motion};
use crate::output;
use crate::shading::Part;

/// Width of the panel at first, points.
pub(super) const WIDTH: f32 = 230.0;

/// What the panel tells beside the settings.
#[derive(Debug)]
pub(super) struct Facts<'a> {
    pub(super) model: &'a Model,
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
        if facts.model.is_deformable() {
            deformation(ui, settings, facts);
        } else {
            transfer(ui, settings, facts);
        }
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
    let order = facts.model.order().get();
    ui.add(Slider::new(&mut settings.order, 1..=order).text("Order"));
}

fn paths(ui: &mut Ui, settings: &mut Settings, facts: &Facts<'_>) {
    ui.heading("Light paths");
    let choices: &[(Part, &str)] = match facts.model.is_deformable() {
        true => &[
            (Part::Unshadowed, "Unshadowed"),
            (Part::Undeformed, "Undeformed (wrong)"),
            (Part::Full, "Lobes"),
            (Part::Traced, "Traced (slow)"),
        ],
        false => &[(Part::Unshadowed, "Unshadowed"), (Part::Shadowed, "Shadowed"), (Part::Full, "Interreflected")],
    };
    for &(part, name) in choices {
        let is_there = facts.parts.contains(&part);
        let button = egui::RadioButton::new(settings.part == part, name);
        let response = ui.add_enabled(is_there, button).on_disabled_hover_text("not in this file");
        if response.clicked() {
            settings.part = part;
        }
    }
}

fn deformation(ui: &mut Ui, settings: &mut Settings, facts: &Facts<'_>) {
    ui.heading("Deformation");
    let motion = &mut settings.motion;
    ui.add(Slider::new(&mut motion.bend, -180.0..=180.0).step_by(1.0).text("Bend"));
    ui.add(Slider::new(&mut motion.twist, -180.0..=180.0).step_by(1.0).text("Twist"));
    ui.add(Slider::new(&mut motion.wave, 0.0..=0.2).step_by(0.005).text("Wave"));
    ui.add(Slider::new(&mut motion.phase, 0.0..=360.0).step_by(1.0).text("Phase"));
    if let Some(actor) = &facts.model.actor {
        clip(ui, motion, actor);
    }
    ui.checkbox(&mut settings.plays, "Play");
    if ui.button("Rest").clicked() {
        settings.motion = Motion::default();
        settings.plays = false;
    }
    ui.checkbox(&mut settings.uses_table, "Light lobes from a table");
}

/// The clip that plays, and the time in it.
fn clip(ui: &mut Ui, motion: &mut Motion, actor: &Actor) {
    let name = |clip: Option<(usize, f32)>| clip.map_or("rest".to_owned(), |(clip, _)| actor.clip_name(clip));
    egui::ComboBox::from_label("Clip").selected_text(name(motion.clip)).show_ui(ui, |ui| {
        ui.selectable_value(&mut motion.clip, None, "rest");
        for clip in 0..actor.clips.len() {
            let is_chosen = motion.clip.is_some_and(|(chosen, _)| chosen == clip);
            if ui.selectable_label(is_chosen, actor.clip_name(clip)).clicked() {
                motion.clip = Some((clip, 0.0));
            }
        }
    });
    if let Some((clip, time)) = &mut motion.clip {
        let duration = actor.clips[*clip].duration() as f32;
        *time = if duration > 0.0 { time.rem_euclid(duration) } else { 0.0 };
        ui.add(Slider::new(time, 0.0..=duration).text("Time"));
    }
}

fn transfer(ui: &mut Ui, settings: &mut Settings, facts: &Facts<'_>) {
    ui.heading("Transfer");
    ui.checkbox(&mut settings.shows_transfer, "Show a coefficient");
    let count = facts.model.order().coeff_count();
    ui.add_enabled(settings.shows_transfer, Slider::new(&mut settings.coefficient, 0..=count - 1).text("i"));
    let (l, m) = settings.band();
    ui.weak(format!("band {l}, m = {m}: orange +, blue -"));
}

fn frame(ui: &mut Ui, settings: &mut Settings, facts: &Facts<'_>) {
    let (geometry, metadata) = (facts.model.geometry(), facts.model.metadata());
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
        facts.model.order(),
        output::count(metadata.rays as u64),
        metadata.bounces
    ));
    ui.label(facts.model.kind());
    ui.label(facts.adapter);
    ui.checkbox(&mut settings.shows_help, "Mouse and keys");
}
