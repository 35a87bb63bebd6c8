//! Writes `shaders/shared/sh_basis.wgsl`, and proves that the file is what it writes. To write it again:
//! `PRT_WRITE_SOURCE=1 cargo test -p prt-gpu --test sh_basis_source`.
#![expect(clippy::unwrap_used, reason = "tests")]

use std::f64::consts::PI;
use std::fmt::Write;

/// Orders up to this one.
const MAX_ORDER: usize = 10;

const HEAD: &str = "\
// Sums of the bands of a light at a direction. Written by tests/sh_basis_source.rs: change that program, not this file.
// Joined before a file that defines light_coefficient(i): the light's coefficient i in three channels.
//
// The basis is y_l,m = p_lm c_m, y_l,-m = p_lm s_m with c_m + i s_m = (x + iy)^m, and p_lm a polynomial of z by the normalised
// recurrence p_lm = a z p_(l-1)m - b p_(l-2)m: no angles, no poles.

";

/// `p_mm`: `(−1)^m √2 K_mm (2m − 1)!!`, and `1/(2√π)` for m = 0.
fn diagonal(m: usize) -> f64 {
    let squared: f64 = (1..=m).map(|k| (2 * k + 1) as f64 / (2 * k) as f64).product::<f64>() / (4.0 * PI);
    let sign = if m.is_multiple_of(2) { 1.0 } else { -1.0 };
    sign * (squared * if m == 0 { 1.0 } else { 2.0 }).sqrt()
}

/// `a` and `b` of the recurrence.
fn factors(l: usize, m: usize) -> (f64, f64) {
    let [l2, m2, before] = [l * l, m * m, (l - 1) * (l - 1)].map(|x| x as f64);
    let a = ((4.0 * l2 - 1.0) / (l2 - m2)).sqrt();
    let b = ((2 * l + 1) as f64 * (before - m2) / ((2.0 * l as f64 - 3.0) * (l2 - m2))).sqrt();
    (a, b)
}

fn polynomial(l: usize, m: usize) -> String {
    if l == m {
        return format!("{:?}", diagonal(m) as f32);
    }
    let (a, b) = factors(l, m);
    match l == m + 1 {
        true => format!("{:?} * z * p{}{m}", a as f32, l - 1),
        false => format!("{:?} * z * p{}{m} - {:?} * p{}{m}", a as f32, l - 1, b as f32, l - 2),
    }
}

fn term(l: usize, m: usize) -> String {
    let i = l * (l + 1);
    match m {
        0 => format!("p{l}0 * light_coefficient({i}u)"),
        _ => format!("p{l}{m} * (c{m} * light_coefficient({}u) + s{m} * light_coefficient({}u))", i + m, i - m),
    }
}

fn band(l: usize) -> String {
    let mut text = String::new();
    if l > 0 {
        write!(text, "    if count < {}u {{\n        return bands;\n    }}\n", l + 1).unwrap();
        let product = |a: &str, b: &str| match l {
            1 => a.to_string(),
            _ => format!("x * {a}{} {b}", l - 1),
        };
        let (c, s) = match l {
            1 => ("x".to_string(), "y".to_string()),
            _ => (product("c", &format!("- y * s{}", l - 1)), product("s", &format!("+ y * c{}", l - 1))),
        };
        writeln!(text, "    let c{l} = {c};\n    let s{l} = {s};").unwrap();
    }
    for m in 0..=l {
        writeln!(text, "    let p{l}{m} = {};", polynomial(l, m)).unwrap();
    }
    let terms: Vec<String> = (0..=l).map(|m| term(l, m)).collect();
    writeln!(text, "    bands[{l}] = {};", terms.join("\n        + ")).unwrap();
    text
}

fn source() -> String {
    let mut text = HEAD.to_string();
    writeln!(text, "const MAX_ORDER: u32 = {MAX_ORDER}u;\n").unwrap();
    text += "// [l]: the sum over m of y_lm(s) light_coefficient(l(l+1) + m), for the first `count` bands; 0 beyond.\n";
    writeln!(text, "fn light_bands(s: vec3<f32>, count: u32) -> array<vec3<f32>, MAX_ORDER> {{").unwrap();
    text += "    var bands: array<vec3<f32>, MAX_ORDER>;\n    let x = s.x;\n    let y = s.y;\n    let z = s.z;\n";
    text.extend((0..MAX_ORDER).map(band));
    text + "    return bands;\n}\n"
}

#[test]
fn the_shader_is_what_this_program_writes() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/shared/sh_basis.wgsl");
    if std::env::var_os("PRT_WRITE_SOURCE").is_some() {
        std::fs::write(path, source()).unwrap();
    }
    assert!(std::fs::read_to_string(path).unwrap() == source(), "run this test with PRT_WRITE_SOURCE=1");
}

/// The recurrence, evaluated here in `f64`, is the basis of sh-core.
#[test]
fn the_recurrence_is_the_basis() {
    let order = sh_core::Order::new(MAX_ORDER).unwrap();
    for direction in sh_core::fibonacci(50) {
        let [x, y, z]: [f64; 3] = direction;
        let mut exact = vec![0.0; order.coeff_count()];
        sh_core::eval(order, [x, y, z], &mut exact);
        let (mut c, mut s) = (1.0, 0.0);
        for m in 0..MAX_ORDER {
            let mut p = [0.0; MAX_ORDER + 1];
            p[m] = diagonal(m);
            for l in m..MAX_ORDER {
                if l > m {
                    let (a, b) = factors(l, m);
                    p[l] = a * z * p[l - 1] - if l > m + 1 { b * p[l - 2] } else { 0.0 };
                }
                let i = l * (l + 1);
                assert!((p[l] * c - exact[i + m]).abs() < 1e-13, "{l} {m}");
                assert!(m == 0 || (p[l] * s - exact[i - m]).abs() < 1e-13, "{l} -{m}");
            }
            (c, s) = (x * c - y * s, x * s + y * c);
        }
    }
}
