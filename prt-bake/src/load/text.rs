//! What the text formats share: UTF-8, numbers, and the place of an error.

use crate::input::Fault;

/// A file, or its part behind `lines_before` lines, as text without a byte-order mark.
pub(super) fn decode(bytes: &[u8], lines_before: usize) -> Result<&str, Fault> {
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let valid = &bytes[..error.valid_up_to()];
        let line = lines_before + 1 + valid.iter().filter(|&&byte| byte == b'\n').count();
        Fault::malformed(format!("line {line} is not UTF-8 text"))
    })?;
    Ok(text.strip_prefix('\u{feff}').unwrap_or(text))
}

/// A number. `nan` and `inf` are numbers here; cleaning drops their faces.
pub(super) fn number(token: &str, line: usize) -> Result<f64, Fault> {
    token.parse().map_err(|_| Fault::malformed(format!("line {line}: `{}` is not a number", excerpt(token))))
}

/// Exactly `N` numbers from the front of `tokens`.
pub(super) fn numbers<'a, const N: usize>(
    tokens: &mut impl Iterator<Item = &'a str>,
    line: usize,
) -> Result<[f64; N], Fault> {
    let mut values = [0.0; N];
    for (given, value) in values.iter_mut().enumerate() {
        let token = tokens
            .next()
            .ok_or_else(|| Fault::malformed(format!("line {line} has {given} numbers where {N} are needed")))?;
        *value = number(token, line)?;
    }
    Ok(values)
}

/// The beginning of a piece of the file, short enough to be printed.
pub(super) fn excerpt(text: &str) -> String {
    const LONGEST: usize = 40;
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}
