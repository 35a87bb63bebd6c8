//! Analytic lights against quadrature, with their normalisations, at ordinary and at extreme parameters.
#![cfg(feature = "alloc")]
#![expect(clippy::unwrap_used, clippy::print_stdout, reason = "tests print what they measured")]

use std::f64::consts::{FRAC_PI_2, PI};

use sh_core::{
    Basis, CieSky, Error, Order, Quadrature, Real, ambient_light, cie_sky, clear_sky, cone_light, directional_light,
    directional_light_normalised, disk_light, eval, hemisphere_light, irradiance, overcast_sky, sphere_light,
};

const AXES: [[f64; 3]; 4] = [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [0.36, -0.48, 0.8], [-0.6, 0.8, 0.0]];

fn order(n: usize) -> Order {
    Order::new(n).unwrap()
}

/// The coefficients that a light writes.
fn written<T: Real>(n: usize, light: impl FnOnce(Order, &mut [T])) -> Vec<T> {
    let mut out = vec![T::from_f64(f64::NAN); n * n];
    light(order(n), &mut out);
    out
}

fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    // NaN counts as large
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, |worst, d| if d <= worst { worst } else { d })
}

/// Two unit vectors that make a right-handed frame with the axis.
fn across(axis: [f64; 3]) -> [[f64; 3]; 2] {
    let [x, y, z] = axis;
    // Duff et al. 2017
    let sign = 1.0_f64.copysign(z);
    let (a, b) = (-1.0 / (sign + z), -x * y / (sign + z));
    [[1.0 + sign * x * x * a, sign * b, -sign * x], [b, sign + y * y * a, -y]]
}

/// Adds `∫ f y_i` over the zone of cosines `low..high` and longitudes `from..to` about an axis, by a product rule of
/// `count²` points; `f(cosine, longitude)`.
struct Zones {
    axis: [f64; 3],
    basis: Basis<f64>,
    rule: Vec<(f64, f64)>,
    sums: Vec<f64>,
}

impl Zones {
    fn new(n: usize, axis: [f64; 3], count: usize) -> Self {
        // Gauss-Legendre on [0, 1], from the rings of a quadrature.
        let quadrature = Quadrature::new(2 * (count - 1));
        let longitudes = quadrature.points().len() / count;
        let rings = quadrature.points().iter().step_by(longitudes);
        let rule = rings.map(|&([_, _, z], w)| (0.5 + 0.5 * z, w * longitudes as f64 / (4.0 * PI))).collect();
        Self { axis, basis: Basis::new(order(n)), rule, sums: vec![0.0; n * n] }
    }

    fn add(&mut self, [low, high]: [f64; 2], [from, to]: [f64; 2], f: impl Fn(f64, f64) -> f64) {
        let ([e1, e2], mut y) = (across(self.axis), vec![0.0; self.sums.len()]);
        for (u, u_weight) in &self.rule {
            for (v, v_weight) in &self.rule {
                let (z, phi) = (low + (high - low) * u, from + (to - from) * v);
                let (s, c) = phi.sin_cos();
                let r = ((1.0 - z) * (1.0 + z)).sqrt();
                self.basis.eval(std::array::from_fn(|k| r * c * e1[k] + r * s * e2[k] + z * self.axis[k]), &mut y);
                let weight = (high - low) * u_weight * (to - from) * v_weight * f(z, phi);
                self.sums.iter_mut().zip(&y).for_each(|(sum, y)| *sum += weight * y);
            }
        }
    }
}

/// `∫ f y_i` of a zonal function about an axis, with kinks at the cuts only.
fn zonal_integral(n: usize, axis: [f64; 3], cuts: &[f64], f: impl Fn(f64) -> f64) -> Vec<f64> {
    let mut zones = Zones::new(n, axis, 24);
    for cut in cuts.windows(2) {
        zones.add([cut[0], cut[1]], [0.0, 2.0 * PI], |z, _| f(z));
    }
    zones.sums
}

#[test]
fn zonal_lights_are_their_integrals() {
    const N: usize = 7;
    for axis in AXES {
        // A length does not matter.
        let long = axis.map(|x| 7.0 * x);
        for radius in [0.01, 0.3, 1.0, FRAC_PI_2, 2.0, 3.0] {
            let disk = written(N, |order, out| disk_light(order, long, radius, out));
            let expected = zonal_integral(N, axis, &[radius.cos(), 1.0], |_| 1.0);
            assert!(difference(&disk, &expected) < 1e-13, "disk {radius} about {axis:?}");
        }
        let ball = written(N, |order, out| sphere_light(order, axis.map(|x| 5.0 * x), 3.0, out));
        assert!(difference(&ball, &zonal_integral(N, axis, &[0.8, 1.0], |_| 1.0)) < 1e-13, "ball {axis:?}");
        let halves = written(N, |order, out| hemisphere_light(order, long, 0.7, 0.2, out));
        let expected = zonal_integral(N, axis, &[-1.0, 0.0, 1.0], |z| if z > 0.0 { 0.7 } else { 0.2 });
        assert!(difference(&halves, &expected) < 1e-13, "hemisphere {axis:?}");
        let overcast = written(N, |order, out| overcast_sky(order, long, out));
        let expected = zonal_integral(N, axis, &[0.0, 1.0], |z| (1.0 + 2.0 * z) / 3.0);
        assert!(difference(&overcast, &expected) < 1e-13, "overcast {axis:?}");
    }
    let ambient = written(N, ambient_light);
    assert!(difference(&ambient, &zonal_integral(N, AXES[2], &[-1.0, 1.0], |_| 1.0)) < 1e-13);
}

#[test]
fn directional_lights_have_their_stated_strength() {
    // The factors of the documentation, as multiples of π.
    let factors = [4.0, 4.0 / 3.0, 16.0 / 17.0, 16.0 / 17.0, 32.0 / 31.0, 32.0 / 31.0];
    for axis in AXES {
        for n in 1..60 {
            let delta = written(n, |order, out| directional_light(order, axis, out));
            let mut y = vec![0.0; n * n];
            eval(order(n), axis, &mut y);
            assert!(difference(&delta, &y) < 1e-14 * n as f64);
            let light = written(n, |order, out| directional_light_normalised(order, axis, out));
            if let Some(factor) = factors.get(n - 1) {
                assert!(difference(&light, &y.iter().map(|y| factor * PI * y).collect::<Vec<_>>()) < 1e-14, "n = {n}");
            }
            assert!((irradiance(order(n), &light, axis) / PI - 1.0).abs() < 1e-13, "n = {n}");
        }
        // Irradiance 1 of the delta function, in the limit: the series alternates, and its terms fall as n^(−3/2).
        let delta = written(200, |order, out| directional_light(order, axis, out));
        assert!((irradiance(order(200), &delta, axis) - 1.0).abs() < 200_f64.powf(-1.5));
    }
}

#[test]
fn cones_reflect_1_at_every_order_and_angle() {
    for n in [1, 2, 3, 4, 5, 6, 10, 33, 64, 129] {
        for angle in [0.0, 1e-300, 1e-5, 0.01, 0.1, 0.5, 1.0, 1.5, FRAC_PI_2, 2.0, 2.5, 3.0, PI, 9.0, f64::NAN, -2.0] {
            let cone = written(n, |order, out| cone_light(order, AXES[2], angle, out));
            assert!((irradiance(order(n), &cone, AXES[2]) / PI - 1.0).abs() < 1e-13, "n = {n}, {angle}");
        }
        let narrow = written(n, |order, out| cone_light(order, AXES[2], 0.0, out));
        let directional = written(n, |order, out| directional_light_normalised(order, AXES[2], out));
        let scale = n as f64 * n as f64;
        assert!(difference(&narrow, &directional) < 1e-15 * scale);
        let wide = written(n, |order, out| cone_light(order, AXES[2], PI, out));
        assert!(difference(&wide, &written(n, ambient_light)) < 1e-14);
    }
    // It has the shape of the disk, of radiance 1/sin².
    let cone = written(60, |order, out| cone_light(order, AXES[3], 0.5, out));
    let disk = written(60, |order, out| disk_light(order, AXES[3], 0.5, out));
    let radiance = cone[0] / disk[0];
    assert!((radiance * f64::sin(0.5).powi(2) - 1.0).abs() < 1e-3);
    assert!(difference(&cone, &disk.iter().map(|f| radiance * f).collect::<Vec<_>>()) < 1e-13);
}

#[test]
fn irradiances_are_the_closed_forms() {
    for n in [3, 4, 6, 20] {
        for axis in AXES {
            let halves = written(n, |order, out| hemisphere_light(order, axis, 0.7, 0.2, out));
            for normal in AXES {
                let cosine: f64 = normal.iter().zip(axis).map(|(a, b)| a * b).sum();
                let expected = PI * (0.7 * 0.5 * (1.0 + cosine) + 0.2 * 0.5 * (1.0 - cosine));
                assert!((irradiance(order(n), &halves, normal) - expected).abs() < 1e-14, "n = {n}");
            }
        }
    }
    let overcast = written(300, |order, out| overcast_sky(order, AXES[2], out));
    assert!((irradiance(order(300), &overcast, AXES[2]) - 7.0 * PI / 9.0).abs() < 1e-6);
    let disk = written(300, |order, out| disk_light(order, AXES[2], 0.4, out));
    assert!((irradiance(order(300), &disk, AXES[2]) - PI * f64::sin(0.4).powi(2)).abs() < 1e-4);
}

#[test]
fn odd_parameters_have_an_answer() {
    let (black, everywhere) = (vec![0.0_f32; 25], written(5, ambient_light::<f32>));
    // Equal but for the rounding of √(4π).
    let close = |a: &[f32], b: &[f32]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 5e-7);
    let disk = |radius| written(5, |order, out| disk_light(order, [0.0_f32, 0.6, 0.8], radius, out));
    for radius in [0.0, -0.0, -1.0, f32::NAN, f32::NEG_INFINITY] {
        assert_eq!(disk(radius), black, "{radius}");
    }
    for radius in [std::f32::consts::PI, 4.0, f32::INFINITY] {
        assert!(close(&disk(radius), &everywhere), "{radius}");
    }
    let ball = |centre, radius| written(5, |order, out| sphere_light::<f32>(order, centre, radius, out));
    for (centre, radius) in [([0.0; 3], 1.0), ([0.0, 1.0, 0.0], 1.0), ([3.0; 3], f32::INFINITY), ([1e-30; 3], 1e-28)] {
        assert!(close(&ball(centre, radius), &everywhere), "{centre:?} {radius}");
    }
    for (centre, radius) in [
        ([0.0; 3], 0.0),
        ([1.0, 0.0, 0.0], -1.0),
        ([1.0; 3], f32::NAN),
        ([f32::NAN, 0.0, 0.0], 1.0),
        ([f32::INFINITY, 0.0, 0.0], 1.0),
        ([0.0, f32::INFINITY, f32::NAN], f32::INFINITY),
    ] {
        assert_eq!(ball(centre, radius), black, "{centre:?} {radius}");
    }
    // As large as they get: half the distance.
    let huge = written(5, |order, out| sphere_light(order, [0.0, 0.0, f64::MAX], f64::MAX / 2.0, out));
    assert!(difference(&huge, &written(5, |order, out| disk_light(order, [0.0, 0.0, 1.0], PI / 6.0, out))) < 1e-14);
    // Directions without a length count as +z.
    for bad in [[0.0_f32; 3], [f32::NAN; 3], [0.0, f32::INFINITY, 0.0]] {
        let z = [0.0, 0.0, 1.0];
        let pairs = [bad, z].map(|d| {
            let mut all = written(5, |order, out| directional_light(order, d, out));
            all.extend(written(5, |order, out| cone_light(order, d, 0.3, out)));
            all.extend(written(5, |order, out| hemisphere_light(order, d, 1.0, 0.5, out)));
            all.extend(written(5, |order, out| overcast_sky(order, d, out)));
            all.extend(written(5, |order, out| clear_sky(order, d, [0.0, 0.6, 0.8], out)));
            all.extend(written(5, |order, out| clear_sky(order, [0.0, 0.6, 0.8], d, out)));
            all
        });
        assert_eq!(pairs[0], pairs[1], "{bad:?}");
    }
}

#[test]
fn every_light_works_at_orders_1_and_512() {
    let axis = [0.36_f32, -0.48, 0.8];
    type Light<'a> = &'a dyn Fn(Order, &mut [f32]);
    let lights: [Light; 8] = [
        &|order, out| directional_light(order, axis, out),
        &|order, out| directional_light_normalised(order, axis, out),
        &|order, out| disk_light(order, axis, 0.01, out),
        &|order, out| sphere_light(order, axis, 0.5, out),
        &|order, out| cone_light(order, axis, 0.2, out),
        &|order, out| hemisphere_light(order, axis, 1.0, 0.5, out),
        &|order, out| overcast_sky(order, axis, out),
        &|order, out| ambient_light(order, out),
    ];
    for light in lights {
        let (one, many) = (written(1, light), written(512, light));
        assert!(one[0] > 0.0 && many.iter().all(|f| f.is_finite()));
    }
}

/// The sky about the zenith, in pieces that shrink towards the sun, the horizon and the zenith.
fn sky_by_pieces(n: usize, sky: CieSky, up: [f64; 3], sun_zenith_angle: f64, sun_longitude: f64) -> Vec<f64> {
    let mut zones = Zones::new(n, up, n + 6);
    let shrink = |from: f64, to: f64| (0..=16).map(move |k| from + (to - from) * 0.5_f64.powi(k));
    let sun_cosine = sun_zenith_angle.cos();
    let towards = [(0.0, 1.0), (1.0, 0.0), (sun_cosine, 0.0), (sun_cosine, 1.0)];
    let mut cuts: Vec<f64> = towards.into_iter().flat_map(|(from, to)| shrink(from, to)).collect();
    cuts.retain(|z| (0.0..=1.0).contains(z));
    cuts.extend([0.0, 1.0]);
    cuts.sort_by(f64::total_cmp);
    let turns: Vec<f64> = shrink(0.0, PI).chain([0.0]).collect();
    for z in cuts.windows(2).filter(|z| z[1] > z[0]) {
        for phi in turns.windows(2) {
            for side in [-1.0, 1.0] {
                let value = |z: f64, phi: f64| {
                    let r = ((1.0 - z) * (1.0 + z)).sqrt();
                    let across = sun_zenith_angle.sin() - r * phi.cos();
                    // half the chord's length is the sine of half the angle
                    let chord2 = across * across + (r * phi.sin()).powi(2) + (z - sun_cosine).powi(2);
                    sky.relative_radiance(z, 2.0 * (0.5 * chord2.sqrt()).min(1.0).asin(), sun_zenith_angle)
                };
                let (from, to) = (sun_longitude + side * phi[1], sun_longitude + side * phi[0]);
                zones.add([z[0], z[1]], [from.min(to), from.max(to)], |z, phi| value(z, phi - sun_longitude));
            }
        }
    }
    zones.sums
}

#[test]
fn skies_are_their_integrals() {
    for (n, sky_type, up, sun_zenith_angle, longitude) in [
        (6, 12, AXES[0], 0.6, 0.0),
        (6, 12, AXES[2], 0.0, 1.0),
        (6, 12, AXES[2], 1.3, 2.0),
        (6, 13, AXES[3], FRAC_PI_2, -1.0),
        (6, 15, AXES[1], 0.2, 0.5),
        (6, 1, AXES[2], 1.0, 0.5),
        (6, 14, AXES[2], 1.9, 0.5),
        (6, 14, AXES[2], 3.1, 0.5),
        (20, 12, AXES[1], 1.1, 0.5),
    ] {
        let sky = CieSky::standard(sky_type).unwrap();
        let [e1, e2] = across(up);
        let (s, c) = f64::sin_cos(longitude);
        let (sz, cz) = f64::sin_cos(sun_zenith_angle);
        let sun = std::array::from_fn(|k| sz * c * e1[k] + sz * s * e2[k] + cz * up[k]);
        let expected = sky_by_pieces(n, sky, up, sun_zenith_angle, longitude);
        let found = written(n, |order, out| cie_sky(order, sky, up, sun, out));
        let error = difference(&found, &expected) / expected[0];
        println!("n = {n}, type {sky_type}, sun at {sun_zenith_angle}: {error:e}");
        let clear_day = sky == CieSky::CLEAR && sun_zenith_angle < FRAC_PI_2;
        assert!(error < if clear_day { 1e-8 } else { 2e-7 });
    }
}

#[test]
fn skies_hold_their_standard() {
    assert_eq!(CieSky::standard(12), Ok(CieSky::CLEAR));
    assert_eq!(CieSky::standard(13), Ok(CieSky::CLEAR_POLLUTED));
    for given in [0, 16, 255] {
        assert_eq!(CieSky::standard(given), Err(Error::SkyType { given }));
    }
    // 1 at the zenith, dark at the horizon and below; type 5 is uniform.
    for sky_type in 1..=15 {
        let sky = CieSky::standard(sky_type).unwrap();
        assert_eq!(sky.relative_radiance(1.0, 0.7, 0.7), 1.0);
        assert_eq!(sky.relative_radiance(0.0, 0.7, 0.7), 0.0);
        assert!(sky.relative_radiance(1e-300, 2.0, 0.7) > 0.0);
    }
    let uniform = CieSky::standard(5).unwrap();
    assert!((uniform.relative_radiance(0.1, 2.0, 0.3) - 1.0).abs() < 1e-15);
    // Clear, sun at 40° from the zenith, by hand: opposite the sun at 50°; χ = 90°.
    let (zenith, f) = (40_f64.to_radians(), |x: f64| {
        1.0 + 10.0 * ((-3.0 * x).exp() - (-3.0 * FRAC_PI_2).exp()) + 0.45 * x.cos().powi(2)
    });
    let phi = |cosine: f64| 1.0 - (-0.32 / cosine).exp();
    let expected = f(FRAC_PI_2) * phi(50_f64.to_radians().cos()) / (f(zenith) * phi(1.0));
    let value = CieSky::CLEAR.relative_radiance(50_f64.to_radians().cos(), FRAC_PI_2, zenith);
    assert!((value - expected).abs() < 1e-15 && (value - 0.6).abs() < 0.4, "{value}");
}

#[test]
fn skies_are_finite_for_every_sun() {
    for n in [1, 2, 30] {
        for sun in [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [1e-200, 0.0, 1.0], [1.0, 0.0, 1e-17], [0.3, -0.8, -0.2]] {
            let sky =
                written::<f32>(n, |order, out| clear_sky(order, [0.0, 0.0, 1.0], sun.map(|x: f64| x as f32), out));
            assert!(sky.iter().all(|f| f.is_finite()) && sky[0] > 0.0, "{n} {sun:?}");
        }
    }
}
