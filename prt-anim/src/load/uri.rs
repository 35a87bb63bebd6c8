//! Data that a glTF document names by URI.

use std::path::Path;

use super::fault::{Fault, read_file};

/// Characters of a URI that a message quotes.
const EXCERPT: usize = 60;

/// The bytes behind a URI: a data URI, or a file beside the document.
pub(super) fn load(uri: &str, folder: &Path) -> Result<Vec<u8>, Fault> {
    if let Some(data) = uri.strip_prefix("data:") {
        return decode_data(data);
    }
    let path = decode_percent(uri);
    if has_scheme(uri) || Path::new(&path).is_absolute() {
        let start: String = uri.chars().take(EXCERPT).collect();
        return Err(Fault::unsupported(format!("data at `{start}` (only relative files and data URIs are read) is")));
    }
    Ok(read_file(&folder.join(path))?)
}

/// `scheme:` with at least two letters, so that no drive letter counts.
fn has_scheme(uri: &str) -> bool {
    let scheme = uri.split(['/', '?', '#']).next().unwrap_or_default().split_once(':').map(|(scheme, _)| scheme);
    scheme.is_some_and(|scheme| {
        scheme.len() > 1 && scheme.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"+-.".contains(&byte))
    })
}

/// What stands behind `data:`: `[type][;base64],contents`.
fn decode_data(data: &str) -> Result<Vec<u8>, Fault> {
    let (kind, contents) = data.split_once(',').ok_or_else(|| Fault::malformed("a data URI has no comma"))?;
    if !kind.ends_with(";base64") {
        return Ok(percent_bytes(contents));
    }
    decode_base64(&percent_bytes(contents)).ok_or_else(|| Fault::malformed("a data URI is not valid base64"))
}

/// `%XX` to bytes; a `%` without two hexadecimal digits stays.
fn percent_bytes(text: &str) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let [first, tail @ ..] = rest {
        let decoded = match tail {
            [high, low, ..] if *first == b'%' => hex(*high).zip(hex(*low)).map(|(high, low)| 16 * high + low),
            _ => None,
        };
        bytes.push(decoded.unwrap_or(*first));
        rest = if decoded.is_some() { &tail[2..] } else { tail };
    }
    bytes
}

fn decode_percent(text: &str) -> String {
    String::from_utf8_lossy(&percent_bytes(text)).into_owned()
}

fn hex(digit: u8) -> Option<u8> {
    char::from(digit).to_digit(16).map(|value| value as u8)
}

/// RFC 4648 base64 with either alphabet, padded or not.
fn decode_base64(text: &[u8]) -> Option<Vec<u8>> {
    let end = text.iter().rposition(|&byte| byte != b'=').map_or(0, |last| last + 1);
    let mut bytes = Vec::with_capacity(end / 4 * 3 + 2);
    for group in text[..end].chunks(4) {
        let mut bits = 0_u32;
        for &digit in group {
            bits = bits << 6 | u32::from(base64_value(digit)?);
        }
        // A lone digit holds less than a byte.
        let whole = match group.len() {
            4 => 3,
            3 => 2,
            2 => 1,
            _ => return None,
        };
        bits <<= 6 * (4 - group.len());
        bytes.extend(&bits.to_be_bytes()[1..=whole]);
    }
    Some(bytes)
}

fn base64_value(digit: u8) -> Option<u8> {
    Some(match digit {
        b'A'..=b'Z' => digit - b'A',
        b'a'..=b'z' => digit - b'a' + 26,
        b'0'..=b'9' => digit - b'0' + 52,
        b'+' | b'-' => 62,
        b'/' | b'_' => 63,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The vectors of RFC 4648, section 10.
    #[test]
    fn base64_vectors() {
        for (text, bytes) in [
            ("", ""),
            ("Zg==", "f"),
            ("Zm8=", "fo"),
            ("Zm9v", "foo"),
            ("Zm9vYg", "foob"),
            ("Zm9vYmE=", "fooba"),
            ("Zm9vYmFy", "foobar"),
        ] {
            assert_eq!(decode_base64(text.as_bytes()).as_deref(), Some(bytes.as_bytes()));
        }
        assert_eq!(decode_base64(b"-_8"), Some(vec![0xfb, 0xff]));
        for bad in ["A", "AAAAA", "A*AA", "A=AA"] {
            assert_eq!(decode_base64(bad.as_bytes()), None, "{bad}");
        }
    }

    #[test]
    fn percent_and_schemes() {
        assert_eq!(decode_percent("a%20b%C3%A9%zz%2"), "a bé%zz%2");
        for (uri, expected) in
            [("http://x/y", true), ("file:x", true), ("a/b:c", false), ("c:x", false), ("x.bin", false)]
        {
            assert_eq!(has_scheme(uri), expected, "{uri}");
        }
    }
}
