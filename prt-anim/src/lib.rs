//! Precomputed radiance transfer as a function of a character's pose, after [NSSF07] and [WXZ06].
//!
//! The crate has its place in the workspace, but no contents yet: skeletons, pose models and shadow fields come with later versions.
//! It stands here empty rather than half done.
//!
//! [NSSF07]: D. Nowrouzezahrai, P. Simari, E. Kalogerakis, K. Singh, E. Fiume. *Compact and Efficient Generation of Radiance Transfer
//! for Dynamically Articulated Characters*. GRAPHITE 2007.
//! [WXZ06]: J. Wang, K. Xu, K. Zhou, S. Lin, S. Hu, B. Guo. *Spherical Harmonics Scaling*. The Visual Computer, 2006.
