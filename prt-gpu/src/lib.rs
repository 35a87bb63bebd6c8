//! Shading with precomputed radiance transfer on the GPU (wgpu), with a plain CPU twin of every step.
//!
//! A surface stores per vertex how it answers light: a transfer vector `[n²]`, once or per colour channel. Under a light `[3, n²]`
//! its exit radiance is `albedo · (transfer · light)`, one dot product ([`cpu::shade_vector`]). The transfer includes `1/π`, the
//! cosine, shadows and what other surfaces reflect; it leaves out the vertex's own albedo. Conventions of the basis: `sh-core`.
//!
//! ```
//! use prt_gpu::{Surface, View, cpu};
//! use sh_core::Order;
//!
//! // One triangle under the open sky of radiance 1: band 0 of its transfer is 1/(2√π), of the light √(4π).
//! let root_pi = std::f32::consts::PI.sqrt();
//! let (order, transfer) = (Order::new(1)?, [0.5 / root_pi; 3]);
//! let positions = [[-1.0, -1.0, 0.5], [1.0, -1.0, 0.5], [0.0, 1.0, 0.5]];
//! let surface = Surface::new(&positions, &[[0, 1, 2]], &[[0.8, 0.4, 0.2]; 3], order, 1, &transfer)?;
//!
//! let identity = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
//! let frame = cpu::render(&surface, &[2.0 * root_pi; 3], order, &View::new(identity, 64, 64, 1)?)?;
//! let [r, g, b, coverage] = frame.pixels[40 * 64 + 32];
//! assert!((r - 0.8).abs() < 1e-5 && (g - 0.4).abs() < 1e-5 && (b - 0.2).abs() < 1e-5 && coverage == 1.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Surfaces that deform
//!
//! A transfer vector is right in the pose that it was baked in. Transfer as a sum of zonal lobes ([`Lobes`]) turns with the surface:
//! [`LobeSurface`] has lobes per vertex, [`TexturedSurface`] maps a texture of lobes in tangent space onto any surface. Both are
//! shaded with a frame per vertex, given by the caller or by skinning ([`Skin`]); glossy lobes also with the eye ([`ViewMap`]). The
//! light is evaluated at the lobes' axes directly or from a table of its bands ([`Evaluation`]), built anew when it changes.
//!
//! | step | GPU | CPU |
//! |---|---|---|
//! | positions and frames of a pose | `skin.wgsl` | [`cpu::skin`] |
//! | table of the light by bands | `build_table.wgsl` | [`cpu::build_table`] |
//! | radiance of vertices | `shade_lobes.wgsl` | [`cpu::shade_lobes`] |
//! | samples of a textured surface to pixels | `resolve_texture.wgsl` | [`cpu::render_textured`] |
//!
//! Twins agree in coverage, depth, and in which texel a sample reads, bit by bit; in radiance within 2e-5 of the mean at vertices and 1e-4 in
//! textures (asserted by `tests/lobes`). Triangles are projected on the CPU, so that every pose's positions are needed there: a
//! skin's are blended on both sides.
//!
//! # An image, step by step
//!
//! | step | GPU | CPU |
//! |---|---|---|
//! | radiance of vertices | `shade_vector.wgsl` | [`cpu::shade_vector`] |
//! | vertices to the screen: projection, clipping, snapping to 1/256 sample | the same code, on the CPU | `assemble` |
//! | nearest triangle at every sample | `draw_surface.wgsl` | [`cpu::rasterize`] |
//! | samples to pixels: radiance, coverage, depth | `resolve.wgsl` | [`cpu::rasterize`] |
//! | display | `present.wgsl` ([`Presenter`]) | [`tone_map`] |
//!
//! # How equal the twins are
//!
//! Coverage and depth are equal bit by bit, silhouettes, thin triangles and intersections included; radiance differs by the rounding
//! of the dot product, below 4e-6 of the mean radiance (asserted by `tests/gpu.rs`; 8e-7 measured on Mesa's lavapipe and llvmpipe).
//! Three choices make it so:
//!
//! - Vertices reach the GPU as integers on the grid that it snaps to, so that the coverage of a triangle is a matter of integers.
//! - The GPU stores only *which* triangle is nearest. Positions inside a triangle come from exact edge functions in the shader, not
//!   from the interpolation of the hardware, whose error in thin triangles is large and differs between drivers.
//! - Depth decides which surface is seen, and is computed with the same roundings on both sides: WGSL lets a compiler fuse or regroup
//!   operations (Mesa does), so the shaders round intermediate results explicitly.
//!
//! The price is a projection of the vertices on the CPU for each new view, 5 ns a vertex, and their upload.
//!
//! # Surfaces seen from the back
//!
//! A surface is lit on one side, where its triangles are counterclockwise. The other side is black and hides what is behind it, as a
//! one-sided diffuse surface in Mitsuba. Of a front and a back at the same place the front is seen.
//!
//! # References
//!
//! - \[SKS02\] P.-P. Sloan, J. Kautz, J. Snyder, "Precomputed radiance transfer for real-time rendering in dynamic, low-frequency
//!   lighting environments", ACM Transactions on Graphics 21(3) (SIGGRAPH), 2002, <https://doi.org/10.1145/566654.566612>
//! - \[SLS05\] P.-P. Sloan, B. Luna, J. Snyder, "Local, deformable precomputed radiance transfer", ACM Transactions on Graphics 24(3)
//!   (SIGGRAPH), 2005, <https://doi.org/10.1145/1186822.1073335>

mod angle;
mod assemble;
mod buffers;
pub mod cpu;
mod device;
mod error;
mod frame;
mod layout;
mod lobe_surface;
mod lobes;
mod pass;
mod renderer;
mod shaders;
mod skin;
mod surface;
mod table;
mod target;
mod textured_surface;
mod tone;
mod triangle;
mod view;
mod view_map;

pub use device::Gpu;
pub use error::Error;
pub use lobe_surface::LobeSurface;
pub use lobes::{LobeShape, Lobes};
pub use pass::{Background, PresentOptions, Presenter, ShadingLimits};
pub use renderer::{LobeRenderer, SurfaceRenderer, TexturedRenderer};
pub use skin::{PoseFrames, Skin};
pub use surface::Surface;
pub use table::{Evaluation, LobeTable};
pub use target::Target;
pub use textured_surface::{LobeSampling, LobeTexture, TexturedSurface};
pub use tone::tone_map;
pub use view::{Frame, View};
pub use view_map::ViewMap;
/// The version of wgpu in whose types this crate speaks.
pub use wgpu;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
