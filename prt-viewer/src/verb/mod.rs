//! One module per verb: its arguments, its report, and what it does.

pub(crate) mod bake;
pub(crate) mod bake_patch;
pub(crate) mod compare;
pub(crate) mod demo;
pub(crate) mod fit;
pub(crate) mod info;
pub(crate) mod main_job;
pub(crate) mod merge;
pub(crate) mod render;
mod reporting;
pub(crate) mod view;
