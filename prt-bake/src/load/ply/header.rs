//! The header of a PLY file.

use crate::input::Fault;
use crate::load::text::excerpt;

/// How the numbers after the header are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// Type of one number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    pub(super) fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    pub(super) fn is_float(self) -> bool {
        matches!(self, Self::F32 | Self::F64)
    }

    /// The largest value, to which an integer colour counts; 1 for a float.
    pub(super) fn full_scale(self) -> f64 {
        match self {
            Self::I8 => f64::from(i8::MAX),
            Self::U8 => f64::from(u8::MAX),
            Self::I16 => f64::from(i16::MAX),
            Self::U16 => f64::from(u16::MAX),
            Self::I32 => f64::from(i32::MAX),
            Self::U32 => f64::from(u32::MAX),
            Self::F32 | Self::F64 => 1.0,
        }
    }

    fn parse(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }
}

/// One number, or a list of them behind its length.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Scalar(Scalar),
    List { length: Scalar, item: Scalar },
}

#[derive(Debug, Clone)]
pub(super) struct Property<'a> {
    pub(super) name: &'a str,
    pub(super) kind: Kind,
}

#[derive(Debug, Clone)]
pub(super) struct Element<'a> {
    pub(super) name: &'a str,
    pub(super) count: usize,
    pub(super) properties: Vec<Property<'a>>,
}

#[derive(Debug, Clone)]
pub(super) struct Header<'a> {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element<'a>>,
    /// Number of lines, so that errors in an ASCII body can count on.
    pub(super) lines: usize,
}

/// The header and the bytes behind it.
pub(super) fn read(bytes: &[u8]) -> Result<(Header<'_>, &[u8]), Fault> {
    let mut rest = bytes;
    if next_line(&mut rest) != Some("ply") {
        return Err(Fault::malformed("it does not begin with the line `ply`"));
    }
    let mut header = Header { encoding: Encoding::Ascii, elements: Vec::new(), lines: 1 };
    let mut has_format = false;
    loop {
        let line = next_line(&mut rest).ok_or_else(|| Fault::malformed("the header has no line `end_header`"))?;
        header.lines += 1;
        let mut words = line.split_ascii_whitespace();
        match words.next() {
            Some("format") => {
                header.encoding = encoding(words.next(), header.lines)?;
                has_format = true;
            }
            Some("element") => header.elements.push(element(&mut words, header.lines)?),
            Some("property") => {
                let property = property(&mut words, header.lines)?;
                let element = header.elements.last_mut();
                element
                    .ok_or_else(|| bad_line(header.lines, "a property before any element"))?
                    .properties
                    .push(property);
            }
            Some("end_header") => break,
            Some("comment" | "obj_info") | None => {}
            Some(word) => return Err(bad_line(header.lines, &format!("unknown keyword `{}`", excerpt(word)))),
        }
    }
    if !has_format {
        return Err(Fault::malformed("the header has no line `format`"));
    }
    Ok((header, rest))
}

/// Takes a line off the front. Lines end with LF, CR LF or (old Macintosh files) CR; bytes that are not UTF-8 may only
/// stand in comments, which therefore count as empty.
fn next_line<'a>(rest: &mut &'a [u8]) -> Option<&'a str> {
    let end = rest.iter().position(|&byte| byte == b'\n' || byte == b'\r')?;
    let line = &rest[..end];
    let ending = if rest[end..].starts_with(b"\r\n") { 2 } else { 1 };
    *rest = &rest[end + ending..];
    if line.starts_with(b"comment") || line.starts_with(b"obj_info") {
        return Some("");
    }
    Some(std::str::from_utf8(line).unwrap_or("?").trim())
}

fn bad_line(line: usize, reason: &str) -> Fault {
    Fault::malformed(format!("header line {line}: {reason}"))
}

fn encoding(word: Option<&str>, line: usize) -> Result<Encoding, Fault> {
    match word {
        Some("ascii") => Ok(Encoding::Ascii),
        Some("binary_little_endian") => Ok(Encoding::LittleEndian),
        Some("binary_big_endian") => Ok(Encoding::BigEndian),
        other => Err(bad_line(line, &format!("unknown encoding `{}`", excerpt(other.unwrap_or_default())))),
    }
}

fn element<'a>(words: &mut impl Iterator<Item = &'a str>, line: usize) -> Result<Element<'a>, Fault> {
    let (Some(name), Some(count)) = (words.next(), words.next()) else {
        return Err(bad_line(line, "an element needs a name and a count"));
    };
    let count = count.parse().map_err(|_| bad_line(line, &format!("`{}` is not a count", excerpt(count))))?;
    Ok(Element { name, count, properties: Vec::new() })
}

fn property<'a>(words: &mut impl Iterator<Item = &'a str>, line: usize) -> Result<Property<'a>, Fault> {
    let mut word = || words.next().ok_or_else(|| bad_line(line, "a property needs a type and a name"));
    let scalar = |name| Scalar::parse(name).ok_or_else(|| bad_line(line, &format!("unknown type `{}`", excerpt(name))));
    let kind = match word()? {
        "list" => {
            let length = scalar(word()?)?;
            if length.is_float() {
                return Err(bad_line(line, "the length of a list must be an integer type"));
            }
            Kind::List { length, item: scalar(word()?)? }
        }
        name => Kind::Scalar(scalar(name)?),
    };
    Ok(Property { name: word()?, kind })
}
