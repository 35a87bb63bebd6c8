//! The numbers behind a PLY header, one after the other, whatever their encoding.

use super::header::{Kind, Property, Scalar};
use crate::input::Fault;
use crate::load::text::excerpt;

/// A source of numbers. Every scalar type fits `f64` exactly.
pub(super) trait Values {
    /// The next number.
    fn next(&mut self, scalar: Scalar) -> Result<f64, Fault>;

    /// Passes over `count` numbers.
    fn skip(&mut self, scalar: Scalar, count: usize) -> Result<(), Fault>;

    /// Bytes not yet read.
    fn bytes_left(&self) -> usize;

    /// The fewest bytes that an element with these properties takes.
    fn least_bytes(&self, properties: &[Property<'_>]) -> usize;
}

/// Numbers as text, separated by blanks and line ends.
#[derive(Debug)]
pub(super) struct Ascii<'a> {
    text: &'a str,
    line: usize,
}

impl<'a> Ascii<'a> {
    pub(super) fn new(text: &'a str, header_lines: usize) -> Self {
        Self { text, line: header_lines + 1 }
    }

    fn token(&mut self) -> Result<&'a str, Fault> {
        let bytes = self.text.as_bytes();
        let start = bytes.iter().position(|byte| !byte.is_ascii_whitespace()).unwrap_or(bytes.len());
        self.line += bytes[..start].iter().filter(|&&byte| byte == b'\n').count();
        let length = bytes[start..].iter().position(u8::is_ascii_whitespace).unwrap_or(bytes.len() - start);
        let (token, rest) = self.text[start..].split_at(length);
        self.text = rest;
        if token.is_empty() {
            return Err(Fault::malformed(format!("it ends in line {} in the middle of the data", self.line)));
        }
        Ok(token)
    }
}

impl Values for Ascii<'_> {
    fn next(&mut self, scalar: Scalar) -> Result<f64, Fault> {
        let token = self.token()?;
        let value =
            if scalar.is_float() { token.parse().ok() } else { token.parse::<i64>().ok().map(|value| value as f64) };
        value.ok_or_else(|| {
            let kind = if scalar.is_float() { "a number" } else { "a whole number" };
            Fault::malformed(format!("line {}: `{}` is not {kind}", self.line, excerpt(token)))
        })
    }

    fn skip(&mut self, _: Scalar, count: usize) -> Result<(), Fault> {
        (0..count).try_for_each(|_| self.token().map(|_| ()))
    }

    fn bytes_left(&self) -> usize {
        // A number that ends with the file needs no separator.
        self.text.len() + 1
    }

    fn least_bytes(&self, properties: &[Property<'_>]) -> usize {
        2 * properties.len()
    }
}

/// Numbers as packed bytes.
#[derive(Debug)]
pub(super) struct Binary<'a, const BIG_ENDIAN: bool> {
    bytes: &'a [u8],
}

impl<'a, const BIG_ENDIAN: bool> Binary<'a, BIG_ENDIAN> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes }
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], Fault> {
        let Some((&head, rest)) = self.bytes.split_first_chunk() else { return Err(truncated()) };
        self.bytes = rest;
        let mut bytes = head;
        if BIG_ENDIAN {
            bytes.reverse();
        }
        Ok(bytes)
    }
}

impl<const BIG_ENDIAN: bool> Values for Binary<'_, BIG_ENDIAN> {
    #[inline]
    fn next(&mut self, scalar: Scalar) -> Result<f64, Fault> {
        Ok(match scalar {
            Scalar::I8 => i8::from_le_bytes(self.take()?).into(),
            Scalar::U8 => u8::from_le_bytes(self.take()?).into(),
            Scalar::I16 => i16::from_le_bytes(self.take()?).into(),
            Scalar::U16 => u16::from_le_bytes(self.take()?).into(),
            Scalar::I32 => i32::from_le_bytes(self.take()?).into(),
            Scalar::U32 => u32::from_le_bytes(self.take()?).into(),
            Scalar::F32 => f32::from_le_bytes(self.take()?).into(),
            Scalar::F64 => f64::from_le_bytes(self.take()?),
        })
    }

    fn skip(&mut self, scalar: Scalar, count: usize) -> Result<(), Fault> {
        let length = scalar.bytes().checked_mul(count).filter(|&length| length <= self.bytes.len());
        self.bytes = &self.bytes[length.ok_or_else(truncated)?..];
        Ok(())
    }

    fn bytes_left(&self) -> usize {
        self.bytes.len()
    }

    fn least_bytes(&self, properties: &[Property<'_>]) -> usize {
        properties
            .iter()
            .map(|property| match property.kind {
                Kind::Scalar(scalar) => scalar.bytes(),
                Kind::List { length, .. } => length.bytes(),
            })
            .sum()
    }
}

fn truncated() -> Fault {
    Fault::malformed("it ends in the middle of the data")
}
