//! What the tests across the crates share: scenes with known answers, independent truths, and the Mitsuba references.

mod brute_force;
mod closed_form;
mod compare;
mod data;
mod reference;
mod scene;

pub use brute_force::{Estimate, brute_force_transfer};
pub use closed_form::{BowlCase, ClosedForms, DiskCase, FacingDisksCase};
pub use compare::{Comparison, compare_inside};
pub use data::data_path;
pub use reference::{Camera, Reference, ReferenceLight, References};
pub use scene::{SceneBuilder, disk, grid, icosphere};
