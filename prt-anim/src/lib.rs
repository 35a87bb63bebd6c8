//! Precomputed radiance transfer as a function of a character's pose, after [NSSF07](sh_core#references) and [WXZ06](sh_core#references).
//!
//! The crate has its place in the workspace, but no contents yet: skeletons, pose models and shadow fields come with later versions.
//! It stands here empty rather than half done.
