//! Radiance pictures: RGBE and XYZE.
//!
//! The crate `image` reads neither XYZE nor the other orientations, and leaves EXPOSURE alone, hence a reader of our own.
//! Source: Greg Ward, "Real Pixels", Graphics Gems II, 1991, and the file formats page of Radiance.

use glam::DMat3;

use super::primaries;
use super::{Image, check_size};
use crate::input::Fault;

/// Most pixels that a byte can stand for here. The new run lengths reach 16; the old ones have no bound, and this one
/// allows a single colour over lines of 4096 pixels.
const PIXELS_PER_BYTE: usize = 1024;

/// Lines that may be run-length coded the new way.
const NEW_RUNS: std::ops::RangeInclusive<usize> = 8..=0x7fff;

type Rgbe = [u8; 4];

pub(super) fn decode(bytes: &[u8]) -> Result<Image, Fault> {
    let mut rest = bytes;
    let header = Header::read(&mut rest)?;
    let layout = Layout::read(next_line(&mut rest)?)?;
    check_size(layout.width, layout.height, rest.len(), PIXELS_PER_BYTE)?;
    let mut pixels = vec![[0.0; 3]; layout.width * layout.height];
    let mut line = Vec::new();
    for major in 0..layout.line_count() {
        read_line(&mut rest, layout.line_length(), &mut line)
            .map_err(|reason| Fault::malformed(format!("line {major} of {} {reason}", layout.line_count())))?;
        for (minor, &code) in line.iter().enumerate() {
            pixels[layout.index(major, minor)] = header.radiance(code);
        }
    }
    Ok(Image { width: layout.width, height: layout.height, pixels })
}

/// The lines before the size.
struct Header {
    /// Factor of each channel: one over the exposure.
    scale: [f32; 3],
    conversion: Option<DMat3>,
}

impl Header {
    fn read(rest: &mut &[u8]) -> Result<Self, Fault> {
        if !rest.starts_with(b"#?") {
            return Err(Fault::malformed("it does not begin with `#?RADIANCE` or `#?RGBE`"));
        }
        let mut exposure = [1.0_f64; 3];
        let mut conversion = None;
        loop {
            let line = next_line(rest)?;
            let (key, value) = line.split_once('=').unwrap_or((line, ""));
            match key.trim() {
                "" => break,
                "FORMAT" => match value.trim() {
                    "32-bit_rle_rgbe" => {}
                    "32-bit_rle_xyze" => conversion = Some(primaries::from_xyz()),
                    other => return Err(Fault::unsupported(format!("the format `{other}` of Radiance pictures is"))),
                },
                "EXPOSURE" => {
                    let [factor] = numbers(key, value)?;
                    exposure = exposure.map(|exposure| exposure * factor);
                }
                "COLORCORR" => {
                    let factors: [f64; 3] = numbers(key, value)?;
                    exposure.iter_mut().zip(factors).for_each(|(exposure, factor)| *exposure *= factor);
                }
                "PRIMARIES" if conversion.is_none() => {
                    let [rx, ry, gx, gy, bx, by, wx, wy] = numbers(key, value)?;
                    conversion = primaries::to_srgb([[rx, ry], [gx, gy], [bx, by], [wx, wy]]);
                }
                _ => {}
            }
        }
        let scale = exposure.map(|exposure| (1.0 / exposure) as f32);
        if !scale.iter().all(|&scale| scale.is_finite() && scale > 0.0) {
            return Err(Fault::malformed(format!("its exposure is {exposure:?}")));
        }
        Ok(Self { scale, conversion })
    }

    /// `m · 2^(e − 128 − 8)`, exposure and primaries undone.
    fn radiance(&self, [red, green, blue, exponent]: Rgbe) -> [f32; 3] {
        if exponent == 0 {
            return [0.0; 3];
        }
        // Exact: the mantissa has 8 bits, and the smallest result is 2^-135, a subnormal with bits to spare.
        let unit = f64::from(i16::from(exponent) - 136).exp2();
        let mut pixel = [red, green, blue].map(|mantissa| (f64::from(mantissa) * unit) as f32);
        pixel.iter_mut().zip(self.scale).for_each(|(value, scale)| *value *= scale);
        match self.conversion {
            Some(matrix) => primaries::convert(matrix, pixel),
            None => pixel,
        }
    }
}

/// Where the pixels of the file lie in the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Layout {
    width: usize,
    height: usize,
    /// Lines of the file are columns of the picture.
    by_columns: bool,
    /// The file begins on the right.
    from_right: bool,
    /// The file begins at the bottom.
    from_bottom: bool,
}

impl Layout {
    /// `-Y height +X width` and its seven relatives; the first axis is that of the lines.
    fn read(line: &str) -> Result<Self, Fault> {
        let bad = || Fault::malformed(format!("`{}` is not a picture size", line.chars().take(40).collect::<String>()));
        let mut words = line.split_ascii_whitespace();
        let mut axis = || {
            let (name, size) = (words.next()?, words.next()?);
            Some((name, size.parse::<usize>().ok()?))
        };
        let (first, second) = axis().zip(axis()).ok_or_else(bad)?;
        let by_columns = first.0.ends_with('X');
        let ((y, height), (x, width)) = if by_columns { (second, first) } else { (first, second) };
        let from_right = match x {
            "+X" => false,
            "-X" => true,
            _ => return Err(bad()),
        };
        let from_bottom = match y {
            "-Y" => false,
            "+Y" => true,
            _ => return Err(bad()),
        };
        Ok(Self { width, height, by_columns, from_right, from_bottom })
    }

    fn line_count(&self) -> usize {
        if self.by_columns { self.width } else { self.height }
    }

    fn line_length(&self) -> usize {
        if self.by_columns { self.height } else { self.width }
    }

    fn index(&self, major: usize, minor: usize) -> usize {
        let (x, y) = if self.by_columns { (major, minor) } else { (minor, major) };
        let column = if self.from_right { self.width - 1 - x } else { x };
        let row = if self.from_bottom { self.height - 1 - y } else { y };
        row * self.width + column
    }
}

/// Takes a header line off the front; what is not UTF-8 (names of files and commands) counts as a comment.
fn next_line<'a>(rest: &mut &'a [u8]) -> Result<&'a str, Fault> {
    let end = rest.iter().position(|&byte| byte == b'\n');
    let end = end.ok_or_else(|| Fault::malformed("it ends within the header"))?;
    let line = std::str::from_utf8(&rest[..end]).unwrap_or("#");
    *rest = &rest[end + 1..];
    Ok(line.trim_end_matches('\r'))
}

fn numbers<const N: usize>(key: &str, text: &str) -> Result<[f64; N], Fault> {
    let values: Option<Vec<f64>> = text.split_ascii_whitespace().map(|word| word.parse().ok()).collect();
    let values = values.and_then(|values| <[f64; N]>::try_from(values).ok());
    values.ok_or_else(|| Fault::malformed(format!("its {key} is not {N} numbers")))
}

/// Reads one line, whichever way it is coded. An error tells how the line is wrong.
fn read_line(rest: &mut &[u8], length: usize, line: &mut Vec<Rgbe>) -> Result<(), String> {
    line.clear();
    match rest.first_chunk() {
        Some(&[2, 2, high, low]) if high < 128 && NEW_RUNS.contains(&length) => {
            let claimed = usize::from(high) << 8 | usize::from(low);
            if claimed != length {
                return Err(format!("claims {claimed} pixels in place of {length}"));
            }
            *rest = &rest[4..];
            read_new_runs(rest, length, line)
        }
        _ => read_old_runs(rest, length, line),
    }
}

/// Each channel by itself: a count above 128 repeats the next byte count − 128 times, others copy count bytes.
fn read_new_runs(rest: &mut &[u8], length: usize, line: &mut Vec<Rgbe>) -> Result<(), String> {
    line.resize(length, [0; 4]);
    for channel in 0..4 {
        let mut x = 0;
        while x < length {
            let (&count, after) = rest.split_first().ok_or("ends early")?;
            let (count, is_run) = if count > 128 { (count - 128, true) } else { (count, false) };
            let count = usize::from(count);
            if count == 0 || count > length - x {
                return Err(format!("has a run of {count} pixels where {} are left", length - x));
            }
            let coded = if is_run { 1 } else { count };
            let (values, after) = after.split_at_checked(coded).ok_or("ends early")?;
            for (i, pixel) in line[x..x + count].iter_mut().enumerate() {
                pixel[channel] = values[if is_run { 0 } else { i }];
            }
            x += count;
            *rest = after;
        }
    }
    Ok(())
}

/// Whole pixels; one of mantissas 1, 1, 1 repeats the last pixel, its exponent being the count, and repeats that follow
/// one another are its higher bytes.
fn read_old_runs(rest: &mut &[u8], length: usize, line: &mut Vec<Rgbe>) -> Result<(), String> {
    let mut shift = 0;
    while line.len() < length {
        let (&code, after) = rest.split_first_chunk::<4>().ok_or("ends early")?;
        *rest = after;
        if code[..3] != [1, 1, 1] {
            line.push(code);
            shift = 0;
            continue;
        }
        let last = *line.last().ok_or("begins with a repeat")?;
        let count = usize::from(code[3]).checked_shl(shift).unwrap_or(usize::MAX);
        if count > length - line.len() {
            return Err(format!("has a run of {count} pixels where {} are left", length - line.len()));
        }
        line.resize(line.len() + count, last);
        shift += 8;
    }
    Ok(())
}
