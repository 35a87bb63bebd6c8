//! Gradients and Hessians of the basis functions on the sphere.
//!
//! A basis function is meant on the sphere: `y(s)`, continued as a constant along rays, `y(s/|s|)`. Its gradient at a unit
//! vector is tangent to the sphere, and its Hessian is that of the continued function. They follow from the solid harmonics
//! `r^l y_lm`, which are homogeneous polynomials. Their derivatives are solid harmonics of the band below, for m > 0:
//!
//! ```text
//! ∂x y_l±m =  a y_l−1,±(m+1) − b y_l−1,±(m−1)      a = ½ √((2l+1)/(2l−1)) √((l−m)(l−m−1))
//! ∂y y_l±m = ±(a y_l−1,∓(m+1) + b y_l−1,∓(m−1))    b = ½ √((2l+1)/(2l−1)) √((l+m)(l+m−1))
//! ∂z y_l±m =  c y_l−1,±m                           c =   √((2l+1)/(2l−1)) √((l−m)(l+m))
//! ```
//!
//! with `y_0` counted √2-fold where m − 1 = 0, and only a half of both terms, `√2 a y_l−1,±1`, where m = 0. There is no
//! division: the poles are ordinary points.

use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

use super::batch::{BLOCK, Groups, store_rows};
use super::recurrence::{self, Tabled};
use super::{Basis, Tables, Values, unrolled};
use crate::order::assert_length;
use crate::simd::{Kernel, Lanes, dispatch};
use crate::{Order, Real};
