//! One module per verb: its arguments, its report, and what it does.

pub(crate) mod bake;
pub(crate) mod compare;
pub(crate) mod demo;
pub(crate) mod info;
pub(crate) mod render;
pub(crate) mod view;
