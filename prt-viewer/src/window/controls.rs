//! Mouse and keys.

use std::f32::consts::PI;

use eframe::egui::{InputState, Key, PointerButton, Response, Ui};

use super::settings::Settings;
use crate::camera::Sphere;
use crate::shading::Part;

/// What the mouse and the keys do, in the words of `--help` and of the window.
const HELP: [(&str, &str); 21] = [
    ("drag", "turn the object"),
    ("middle drag, Shift+drag", "move the object"),
    ("wheel, pinch", "nearer or farther"),
    ("right drag, Ctrl+drag, Alt+drag", "turn the light"),
    ("drop a file", "add an environment, .hdr or .exr (not on Wayland)"),
    ("E, Shift+E", "next, previous environment"),
    ("B", "environment in the background on or off"),
    ("+, -", "brighter, darker by half a stop"),
    (". ,", "one band more, one less"),
    ("1, 2, 3", "unshadowed; shadowed, or undeformed lobes; all that is there"),
    ("4", "transfer traced anew in this pose: the truth, and slow"),
    ("Space", "the clip plays, or the wave travels; again: it stops"),
    ("T", "show a coefficient of the transfer: orange is positive, blue negative"),
    ("], [", "next, previous coefficient"),
    ("R", "camera as at first"),
    ("L", "light as at first"),
    ("A", "exposure that suits the picture"),
    ("F", "draw all the time, to measure the frame time"),
    ("S", "save the picture beside the file"),
    ("H", "these lines on or off"),
    ("Q, Esc", "close"),
];

/// Keys that choose a part, where there is one.
const PARTS: [(Key, Part); 5] = [
    (Key::Num1, Part::Unshadowed),
    (Key::Num2, Part::Shadowed),
    (Key::Num2, Part::Undeformed),
    (Key::Num3, Part::Full),
    (Key::Num4, Part::Traced),
];

/// The lines of [`HELP`].
pub(crate) fn help_text() -> String {
    let width = HELP.iter().map(|(keys, _)| keys.len()).max().unwrap_or_default();
    let lines: Vec<String> = HELP.iter().map(|(keys, effect)| format!("  {keys:<width$}  {effect}")).collect();
    lines.join("\n")
}

/// What only the app can do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Action {
    SavePicture,
    ExposeAutomatically,
    Close,
}

/// What the keys may choose among.
#[derive(Debug)]
pub(super) struct Choices<'a> {
    pub(super) environment_count: usize,
    pub(super) order: usize,
    pub(super) parts: &'a [Part],
    /// As it was at first.
    pub(super) start: &'a Settings,
}

/// Applies the keys that were pressed.
pub(super) fn keys(input: &InputState, settings: &mut Settings, choices: &Choices<'_>) -> Option<Action> {
    let pressed = |key| input.key_pressed(key) && !input.modifiers.command;
    let toggle = |value: &mut bool, key| *value ^= pressed(key);
    toggle(&mut settings.shows_environment, Key::B);
    toggle(&mut settings.shows_transfer, Key::T);
    toggle(&mut settings.shows_help, Key::H);
    toggle(&mut settings.draws_continuously, Key::F);
    toggle(&mut settings.plays, Key::Space);
    if pressed(Key::E) {
        let step = if input.modifiers.shift { choices.environment_count - 1 } else { 1 };
        settings.environment = (settings.environment + step) % choices.environment_count;
    }
    if pressed(Key::Plus) || pressed(Key::Equals) {
        settings.expose(0.5);
    }
    if pressed(Key::Minus) {
        settings.expose(-0.5);
    }
    settings.order = stepped(settings.order, 1, choices.order, pressed(Key::Comma), pressed(Key::Period));
    let (down, up) = (pressed(Key::OpenBracket), pressed(Key::CloseBracket));
    settings.coefficient = stepped(settings.coefficient, 0, choices.order.pow(2) - 1, down, up);
    for (key, part) in PARTS {
        if pressed(key) && choices.parts.contains(&part) {
            settings.part = part;
        }
    }
    if pressed(Key::R) {
        settings.orbit = choices.start.orbit;
    }
    if pressed(Key::L) {
        settings.scene_from_environment = choices.start.scene_from_environment;
    }
    action(pressed)
}

fn action(pressed: impl Fn(Key) -> bool) -> Option<Action> {
    let actions = [
        (Key::S, Action::SavePicture),
        (Key::A, Action::ExposeAutomatically),
        (Key::Q, Action::Close),
        (Key::Escape, Action::Close),
    ];
    actions.into_iter().find_map(|(key, action)| pressed(key).then_some(action))
}

fn stepped(value: usize, least: usize, most: usize, down: bool, up: bool) -> usize {
    (value + usize::from(up)).saturating_sub(usize::from(down)).clamp(least, most)
}

/// Applies what the mouse did over the picture.
pub(super) fn mouse(ui: &Ui, response: &Response, settings: &mut Settings, around: Sphere) {
    let height = response.rect.height().max(1.0);
    // egui's y points down.
    let [to_right, upwards] = [response.drag_delta().x / height, -response.drag_delta().y / height];
    let (modifiers, zoom) = ui.input(|input| (input.modifiers, zoom_factor(input)));
    let is_primary = response.dragged_by(PointerButton::Primary);
    if response.dragged_by(PointerButton::Secondary) || (is_primary && (modifiers.alt || modifiers.ctrl)) {
        settings.turn_light(PI * to_right, PI * upwards);
    } else if response.dragged_by(PointerButton::Middle) || (is_primary && modifiers.shift) {
        settings.orbit.pan(to_right, upwards);
    } else if is_primary {
        settings.orbit.turn(PI * to_right, PI * upwards);
    }
    if response.contains_pointer() && zoom != 1.0 {
        settings.orbit.zoom(zoom, around);
    }
}

/// By how much the wheel and the fingers change the distance.
fn zoom_factor(input: &InputState) -> f32 {
    /// Points of scrolling that halve the distance, roughly six clicks of a wheel.
    const HALVING: f32 = 240.0;
    (-input.smooth_scroll_delta().y / HALVING).exp2() / input.zoom_delta()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_stay_in_their_range() {
        assert_eq!(stepped(6, 1, 6, false, true), 6);
        assert_eq!(stepped(1, 1, 6, true, false), 1);
        assert_eq!(stepped(3, 1, 6, false, true), 4);
        assert_eq!(stepped(0, 0, 35, true, false), 0);
    }

    #[test]
    fn help_names_every_key_that_acts() {
        let text = help_text();
        for key in [
            "E", "B", "+", "-", ".", ",", "1", "2", "3", "4", "Space", "T", "[", "]", "R", "L", "A", "F", "S", "H", "Q",
        ] {
            assert!(
                text.lines()
                    .any(|line| line.split_whitespace().any(|word| word.trim_matches(',') == key || word == key)),
                "{key}"
            );
        }
    }
}
