//! Real spherical harmonics to any order: evaluate, project, light, rotate, multiply, convolve, scale, window, extract.
//!
//! This page fixes the conventions once, for this crate and for everything that is built on it.
//!
//! # What is where
//!
//! Functions work on slices of stated shape; [`Sh`] owns its coefficients, for orders that are known when the program is
//! compiled.
//!
//! | to do | with |
//! |---|---|
//! | evaluate the basis | [`eval`]; [`Basis`] for many directions; [`eval_gradient`], [`eval_hessian`], [`BasisGradient`] |
//! | evaluate an expansion | [`reconstruct`], [`Basis::reconstruct`], [`reconstruct_lat_long`], [`reconstruct_cube`] |
//! | expand a function | [`project_function`]; [`Basis::project`] for samples with weights, [`LeastSquares`] for those without |
//! | expand a map | [`project_lat_long`], [`project_cube`] |
//! | analytic lights | [`directional_light`], [`disk_light`], [`sphere_light`], [`cone_light`], [`hemisphere_light`], [`ambient_light`], [`polygon_light`], [`overcast_sky`], [`clear_sky`], [`cie_sky`] |
//! | rotate | [`rotate`], [`rotate_quaternion`], [`rotate_z`]; [`ShRotation`] for many vectors; [`Zxzxz`] by tables; [`Taylor`] for small angles |
//! | multiply | [`product`], [`product_many`], [`square`], [`product_matrix`], [`triple_product`]; [`exp`], [`log`] |
//! | zonal functions | [`zonal_value`], [`project_zonal`], [`expand_zonal`], [`expand_lobe`], [`convolve`]; kernels from [`clamped_cosine`] to [`ggx_kernel`]; [`fit_lobe_about_axis`] |
//! | scale about an axis | [`ScalingMatrix`], [`ScalingTable`] |
//! | fade out ringing | [`hanning`], [`lanczos`], [`laplacian`], [`gaussian`], [`nonnegative_window`]; [`minimum`] |
//! | extract | [`dominant_light`], [`irradiance`], [`irradiance_matrices`], [`band_energy`] |
//! | exchange with other libraries | [`toggle_condon_shortley`], [`from_splat`], [`from_filament`], [`from_complex`], [`y_up_from_z_up`] |
//!
//! # Words
//!
//! | word | meaning |
//! |---|---|
//! | order `n` | the number of bands; the bands are `l = 0..n` |
//! | band `l`, `m` | `m = -l..=l` within the band: `2l+1` functions |
//! | index `i` | `i = l(l+1) + m`, see [`index`]; coefficients are slices `[n²]` |
//! | zonal coefficients | `[n]`, one per band: a function that is symmetric about +z |
//! | lobe, axis | zonal coefficients that are used about a unit direction |
//! | light | `[3, n²]`, channel-major: incident radiance in the frame of the scene |
//!
//! # Basis
//!
//! Real, orthonormal on the unit sphere, **with** the Condon-Shortley phase `(−1)^m`. With `theta` from +z, `phi` from +x
//! towards +y, and `P_l^m` the associated Legendre function *without* that phase:
//!
//! ```text
//! K_lm  = sqrt( (2l+1)/(4π) · (l−|m|)!/(l+|m|)! )
//! y_lm  = (−1)^m √2 K_lm cos(m phi)   P_l^m(cos theta)      m > 0
//! y_l0  =           K_l0              P_l(cos theta)
//! y_lm  = (−1)^m √2 K_lm sin(|m| phi) P_l^|m|(cos theta)    m < 0
//! ```
//!
//! As polynomials of a unit vector `(x, y, z)`, the fingerprint by which another library's coefficients are recognised:
//!
//! ```text
//! i  l  m   y_i
//! 0  0  0   +1/(2√π)            = +0.28209479177387814
//! 1  1 −1   −√(3/(4π)) y        = −0.4886025119029199 y
//! 2  1  0   +√(3/(4π)) z        = +0.4886025119029199 z
//! 3  1 +1   −√(3/(4π)) x        = −0.4886025119029199 x
//! 4  2 −2   +½ √(15/π) x y      = +1.0925484305920792 x y
//! 5  2 −1   −½ √(15/π) y z      = −1.0925484305920792 y z
//! 6  2  0   +¼ √(5/π) (3z² − 1) = +0.31539156525252005 (3z² − 1)
//! 7  2 +1   −½ √(15/π) x z      = −1.0925484305920792 x z
//! 8  2 +2   +¼ √(15/π) (x² − y²) = +0.5462742152960396 (x² − y²)
//! ```
//!
//! The papers, DirectX and 3D Gaussian splats use the same signs. Libraries without the phase (sphericart, sphrs, SciPy-style
//! real harmonics, three.js) differ by the factor `(−1)^m` for each coefficient. "Order" there may mean `l_max = n − 1`.
//! Converters: [`toggle_condon_shortley`], [`to_complex`], [`from_splat`], [`to_filament`], [`z_up_from_y_up`], and back.
//!
//! # Frames
//!
//! A direction is a unit vector `[x, y, z]` in the frame of the scene. The polar axis of the basis is that frame's **+z**,
//! whatever is up. The optimal linear lobe of `f` has the axis `(−f_11, −f_1−1, f_10)` (not normalised).
//! Maps have y up: [`LatLong`] is oriented as Mitsuba's `envmap`, [`CubeMap`] as OpenGL's cube map faces.
//!
//! # Zonal functions
//!
//! A zonal function about +z has the coefficients `g_l` of its `y_l0`. About an axis `a` it is `f_lm = √(4π/(2l+1)) g_l
//! y_lm(a)` ([`expand_zonal`]). The *lobe coefficients* of [SLS05](crate#references) eq. 4 and 6 are `g*_l = √(4π/(2l+1))
//! g_l` ([`lobe_from_zonal`]): these are what is stored for lobes, and `f_lm = g*_l y_lm(a)` ([`expand_lobe`]).
//!
//! # Rotation
//!
//! Rotating `f` by `R` gives `g(s) = f(R⁻¹ s)`: a feature of `f` in the direction `d` is in the direction `R d` of `g`.
//! [`ShRotation`] turns the coefficients of `f` into those of `g`, band by band, for many expansions; [`rotate`] does it for
//! one, without building a matrix.
//!
//! # Precision
//!
//! Everything is generic over [`Real`], that is `f32` and `f64`. Evaluation uses fully normalised recurrences in `x, y, z`:
//! no angles, no trigonometry, no division by `sin theta`, so the poles are ordinary points. Sums over maps and quadrature
//! points are taken in `f64`, and rotations are built in `f64`, whatever the type of the coefficients.
//!
//! # Features
//!
//! | feature | default | gives |
//! |---|---|---|
//! | `std` | yes | the standard library's floating-point functions; implies `alloc` |
//! | `alloc` | by `std` | [`Basis`], [`Quadrature`], [`fibonacci`], [`ShRotation`], [`Zxzxz`], [`Taylor`], [`ScalingMatrix`], [`ProductMatrix`], [`ProductTransform`], [`TripleTensor`], [`gaunt`], [`log`], [`LeastSquares`], [`minimum`], [`minimum_zonal`], [`nonnegative_window`], [`project_zonal`], [`irradiance`], [`y_up_from_z_up`], [`z_up_from_y_up`], projection, reconstruction of maps, [`polygon_light`], skies; products and exponentials beyond n = 6, which panic without it |
//! | `libm` | no | floating-point functions without the standard library (`no_std`) |
//! | `glam` | no | [`RotationRows`] of glam's matrices and quaternions |
//! | `nalgebra` | no | [`RotationRows`] of nalgebra's rotations and unit quaternions, [`ScalingMatrix`] as a `DMatrix`; implies `alloc` |
//! | `serde` | no | reading and writing of [`Order`], [`Sh`], [`LatLong`], [`CubeMap`], [`Tau`], [`Preserve`], [`Interpolation`], [`Window`], [`SplatLayout`] |
//!
//! One of `std` and `libm` is needed.
//!
//! # References
//!
//! Keys in the documentation of this workspace resolve here.
//!
//! - **\[SKS02\]** P.-P. Sloan, J. Kautz, J. Snyder. *Precomputed Radiance Transfer for Real-Time Rendering in Dynamic,
//!   Low-Frequency Lighting Environments.* ACM Transactions on Graphics 21(3) (SIGGRAPH), 2002.
//!   <https://doi.org/10.1145/566654.566612>. Erratum: the volume transfer of section 7 as printed lacks the scattering
//!   coefficient, the path length and the factor 1/N, so its first bounce is 2-4 times too bright and depends on the grid.
//! - **\[SLS05\]** P.-P. Sloan, B. Luna, J. Snyder. *Local, Deformable Precomputed Radiance Transfer.* ACM Transactions on
//!   Graphics 24(3) (SIGGRAPH), 2005. <https://doi.org/10.1145/1186822.1073335>. Note: the membrane's `g*_l` of eq. 23 are
//!   already divided by π.
//! - **\[KKP05\]** J. Křivánek, J. Konttinen, S. Pattanaik, K. Bouatouch, J. Žára. *Fast Approximation to Spherical
//!   Harmonics Rotation.* IRISA research report 1728, 2005; Spring Conference on Computer Graphics, 2006,
//!   <https://doi.org/10.1145/2602161.2602167>; sketch at SIGGRAPH 2006, <https://doi.org/10.1145/1179849.1180042>.
//!   Erratum: the limit `1.25 a` for the angle (Appendix B) ignores the order; the worst error is about `0.25 ((n−1)β)²`,
//!   so a tolerance `e` allows `β ≤ 2√e/(n−1)`.
//! - **\[WXZ06\]** J. Wang, K. Xu, K. Zhou, S. Lin, S. Hu, B. Guo. *Spherical Harmonics Scaling.* The Visual Computer
//!   22(9-11), 2006. <https://doi.org/10.1007/s00371-006-0057-8>. Note: truncated scaling matrices do not compose; scale
//!   from the captured expansion.
//! - **\[NSSF07\]** D. Nowrouzezahrai, P. Simari, E. Kalogerakis, K. Singh, E. Fiume. *Compact and Efficient Generation of
//!   Radiance Transfer for Dynamically Articulated Characters.* GRAPHITE, 2007.
//!   <http://www.dgp.toronto.edu/~derek/Graphite07_DynamicShadowing.html>. Erratum: table 2 counts a megabyte as 1,024,000
//!   bytes in some columns and as 2²⁰ in the Armadillo's.
//! - **\[IR96\]** J. Ivanic, K. Ruedenberg. *Rotation Matrices for Real Spherical Harmonics. Direct Determination by
//!   Recursion.* The Journal of Physical Chemistry 100(15), 1996. <https://doi.org/10.1021/jp953350u>. Errata: *Additions
//!   and Corrections*, The Journal of Physical Chemistry A 102(45), 1998, <https://doi.org/10.1021/jp9833350>, replace the
//!   tables of `u, v, w` and `U, V, W`, and are themselves reported to be misprinted in `V` for m < 0. The form used here
//!   is proved by tests: its factors are orthonormal, and rotation commutes with evaluation.
//! - **\[Slo08\]** P.-P. Sloan. *Stupid Spherical Harmonics (SH) Tricks.* Game Developers Conference, 2008.
//! - **\[Slo17\]** P.-P. Sloan. *Deringing Spherical Harmonics.* SIGGRAPH Asia Technical Briefs, 2017.
//!   <https://doi.org/10.1145/3145749.3149438>.
//! - **\[KKLD23\]** B. Kerbl, G. Kopanas, T. Leimkühler, G. Drettakis. *3D Gaussian Splatting for Real-Time Radiance Field
//!   Rendering.* ACM Transactions on Graphics 42(4) (SIGGRAPH), 2023. <https://doi.org/10.1145/3592433>.
//! - **\[VMK88\]** D. A. Varshalovich, A. N. Moskalev, V. K. Khersonskii. *Quantum Theory of Angular Momentum.* World
//!   Scientific, 1988. <https://doi.org/10.1142/0270>.
//! - **\[Zyg02\]** A. Zygmund. *Trigonometric Series.* Third edition, Cambridge University Press, 2002 (first 1935).
//!   <https://doi.org/10.1017/CBO9781316036587>.
//! - **\[RH01\]** R. Ramamoorthi, P. Hanrahan. *An Efficient Representation for Irradiance Environment Maps.* SIGGRAPH, 2001.
//!   <https://doi.org/10.1145/383259.383317>.
//! - **\[RWS06\]** Z. Ren, R. Wang, J. Snyder, K. Zhou, X. Liu, B. Sun, P.-P. Sloan, H. Bao, Q. Peng, B. Guo. *Real-time
//!   Soft Shadows in Dynamic Scenes using Spherical Harmonic Exponentiation.* ACM Transactions on Graphics 25(3)
//!   (SIGGRAPH), 2006. <https://doi.org/10.1145/1179352.1141982>.
//! - **\[OS83\]** A. van Oosterom, J. Strackee. *The Solid Angle of a Plane Triangle.* IEEE Transactions on Biomedical
//!   Engineering 30(2), 1983. <https://doi.org/10.1109/TBME.1983.325207>.
//! - **\[DLMF\]** *NIST Digital Library of Mathematical Functions.* <https://dlmf.nist.gov>.
//! - **\[RH02\]** R. Ramamoorthi, P. Hanrahan. *Frequency Space Environment Map Rendering.* ACM Transactions on Graphics
//!   21(3) (SIGGRAPH), 2002.
//! - **\[Bue04\]** T. Bülow. *Spherical Diffusion for 3D Surface Smoothing.* IEEE Transactions on Pattern Analysis and
//!   Machine Intelligence 26(12), 2004.
//! - **\[HSRG07\]** C. Han, B. Sun, R. Ramamoorthi, E. Grinspun. *Frequency Domain Normal Map Filtering.* ACM Transactions on
//!   Graphics 26(3) (SIGGRAPH), 2007. <http://www.cs.columbia.edu/cg/normalmap/>.
//! - **\[WRGSG09\]** J. Wang, P. Ren, M. Gong, J. Snyder, B. Guo. *All-Frequency Rendering of Dynamic, Spatially-Varying
//!   Reflectance.* ACM Transactions on Graphics 28(5) (SIGGRAPH Asia), 2009. <https://doi.org/10.1145/1618452.1618479>.
//! - **\[WMLT07\]** B. Walter, S. Marschner, H. Li, K. Torrance. *Microfacet Models for Refraction through Rough Surfaces.*
//!   Eurographics Symposium on Rendering, 2007. <https://doi.org/10.2312/EGWR/EGSR07/195-206>.
//! - **\[MS42\]** P. Moon, D. Spencer. *Illumination from a Non-Uniform Sky.* Transactions of the Illuminating Engineering
//!   Society 37, 1942.
//! - **\[CIE03\]** *Spatial Distribution of Daylight: CIE Standard General Sky.* CIE S 011/E:2003, ISO 15469:2004.
//! - **\[WR18\]** J. Wang, R. Ramamoorthi. *Analytic Spherical Harmonic Coefficients for Polygonal Area Lights.* ACM
//!   Transactions on Graphics 37(4) (SIGGRAPH), 2018. <https://doi.org/10.1145/3197517.3201291>.

#![no_std]
#![cfg_attr(
    not(feature = "alloc"),
    allow(rustdoc::broken_intra_doc_links, reason = "the page names items that need the feature `alloc`")
)]

#[cfg(feature = "alloc")]
extern crate alloc;
#[cfg(feature = "std")]
extern crate std;

#[cfg(not(any(feature = "std", feature = "libm")))]
compile_error!("sh-core needs floating-point functions: enable its feature `std` (the default) or `libm`");

mod basis;
mod convention;
mod direction;
mod error;
mod expansion;
mod exponential;
mod extract;
#[cfg(feature = "glam")]
mod glam;
mod light;
mod maps;
#[cfg(feature = "nalgebra")]
mod nalgebra;
mod order;
mod product;
#[cfg(feature = "alloc")]
mod project;
mod real;
mod rotation;
mod rows;
mod scaling;
#[cfg(feature = "serde")]
mod serde;
#[cfg_attr(not(feature = "alloc"), allow(dead_code, reason = "a scalar is one lane; wider ones are for batches"))]
mod simd;
#[cfg(feature = "alloc")]
mod sphere;
mod vector;
mod window;
mod zonal;

#[cfg(feature = "alloc")]
pub use basis::{BLOCK, Basis, BasisGradient};
pub use basis::{eval, eval_gradient, eval_hessian, reconstruct};
pub use convention::{
    SplatLayout, from_complex, from_filament, from_splat, to_complex, to_filament, to_splat, toggle_condon_shortley,
};
#[cfg(feature = "alloc")]
pub use convention::{y_up_from_z_up, z_up_from_y_up};
pub use error::Error;
pub use expansion::{Sh, Sh1, Sh2, Sh3, Sh4, Sh5, Sh6, Sh7, Sh8, Sh9, Sh10};
#[cfg(feature = "alloc")]
pub use exponential::log;
pub use exponential::{ExpOptions, ExpStart, exp};
#[cfg(feature = "alloc")]
pub use extract::irradiance;
pub use extract::{
    DominantLight, band_energy, dominant_direction, dominant_light, irradiance_from_radiance, irradiance_matrices,
};
#[cfg(feature = "alloc")]
pub use light::{CieSky, cie_sky, clear_sky, polygon_light};
pub use light::{
    ambient_light, cone_light, directional_light, directional_light_normalised, disk_light, hemisphere_light,
    overcast_sky, sphere_light,
};
pub use maps::{CubeMap, LatLong};
pub use order::{Order, index};
#[cfg(feature = "alloc")]
pub use product::{ProductMatrix, ProductTransform, TripleTensor, gaunt};
pub use product::{product, product_many, product_matrix, square, triple_product};
#[cfg(feature = "alloc")]
pub use project::{
    LeastSquares, project_cube, project_function, project_lat_long, reconstruct_cube, reconstruct_lat_long,
};
pub use real::Real;
#[cfg(feature = "alloc")]
pub use rotation::{ShRotation, Taylor, TaylorDegree, Zxzxz, radiance_cache_angle_limit, taylor_angle_limit};
pub use rotation::{Zyz, rotate, rotate_quaternion, rotate_z, rotate_zyz};
pub use rows::RotationRows;
#[cfg(feature = "alloc")]
pub use scaling::{Interpolation, ScalingMatrix, ScalingTable, geometric_nodes};
pub use scaling::{Preserve, Tau};
#[cfg(feature = "alloc")]
pub use sphere::{Quadrature, fibonacci};
pub use vector::{dot, scale_bands};
#[cfg(feature = "alloc")]
pub use window::{Minimum, minimum, minimum_zonal, nonnegative_window};
pub use window::{Window, gaussian, hanning, lanczos, laplacian, laplacian_lambda};
#[cfg(feature = "alloc")]
pub use zonal::project_zonal;
pub use zonal::{
    cap_kernel, clamped_cosine, clamped_cosine_power, convolve, expand_lobe, expand_zonal, fit_lobe_about_axis,
    gaussian_kernel, ggx_kernel, linear_axis, lobe_from_zonal, lobe_value, phong_kernel, spherical_cap,
    spherical_gaussian, von_mises_fisher_kernel, zonal_from_lobe, zonal_value,
};

#[cfg(all(doctest, feature = "std"))]
#[doc = include_str!("../README.md")]
struct Readme;
