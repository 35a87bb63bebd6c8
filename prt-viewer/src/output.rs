//! What the program says: results on the standard output, everything else on the standard error.

use std::fmt::Display;
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

use anyhow::Context;
use serde::Serialize;

use crate::cancel;

/// As clap exits.
const WRONG_USAGE: u8 = 2;

/// Prints the result of a verb on the standard output: one JSON object, or the summary for people.
pub(crate) fn result(json: bool, report: &impl Serialize, summary: impl FnOnce() -> String) -> anyhow::Result<()> {
    let text = if json { serde_json::to_string(report).context("cannot write JSON")? } else { summary() };
    let mut out = std::io::stdout().lock();
    match writeln!(out, "{text}").and_then(|()| out.flush()) {
        // Who reads it has read enough.
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        written => written.context("cannot write to the standard output"),
    }
}

/// A line for people on the standard error.
pub(crate) fn note(line: impl Display) {
    // Nobody is left to tell if the standard error is closed.
    let _ = writeln!(std::io::stderr(), "prt: {line}");
}

/// An error of usage that only shows when all arguments are known.
#[derive(Debug)]
struct Usage(&'static str);

impl Display for Usage {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.0)
    }
}

impl std::error::Error for Usage {}

/// Wrong usage: exit status 2.
pub(crate) fn usage(message: &'static str) -> anyhow::Error {
    Usage(message).into()
}

/// Prints the error in one line; returns the exit status that goes with it.
pub(crate) fn failure(error: &anyhow::Error) -> ExitCode {
    if error.chain().any(|cause| matches!(cause.downcast_ref(), Some(prt_bake::Error::Cancelled))) {
        note("cancelled");
        return ExitCode::from(cancel::EXIT_STATUS);
    }
    note(format_args!("error: {}", one_line(error)));
    if error.is::<Usage>() { ExitCode::from(WRONG_USAGE) } else { ExitCode::FAILURE }
}

/// An error and its causes.
pub(crate) fn one_line(error: &anyhow::Error) -> String {
    let text = format!("{error:#}");
    text.split(['\n', '\r']).map(str::trim).filter(|part| !part.is_empty()).collect::<Vec<_>>().join("; ")
}

/// A count with a comma between thousands.
pub(crate) fn count(number: u64) -> String {
    let digits = number.to_string();
    let head = digits.len() % 3;
    let groups = (0..digits.len()).skip(head).step_by(3).map(|start| &digits[start..start + 3]);
    let first = Some(&digits[..head]).filter(|first| !first.is_empty());
    first.into_iter().chain(groups).collect::<Vec<_>>().join(",")
}

/// A size in bytes, in units that people read.
pub(crate) fn bytes(number: u64) -> String {
    match number {
        0..1_000 => format!("{number} bytes"),
        1_000..1_000_000 => format!("{:.1} kB", number as f64 / 1e3),
        1_000_000..1_000_000_000 => format!("{:.1} MB", number as f64 / 1e6),
        _ => format!("{:.2} GB", number as f64 / 1e9),
    }
}

/// The name of a file without its folders.
pub(crate) fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_have_commas_between_thousands() {
        let counts = [0, 12, 999, 1_000, 34_834, 1_234_567].map(count);
        assert_eq!(counts, ["0", "12", "999", "1,000", "34,834", "1,234,567"]);
    }

    #[test]
    fn sizes_have_units() {
        assert_eq!([12, 1_500, 5_016_096, 7_250_000_000].map(bytes), ["12 bytes", "1.5 kB", "5.0 MB", "7.25 GB"]);
    }

    #[test]
    fn an_error_is_one_line_whatever_its_cause_says() {
        let error = anyhow::anyhow!("first\n  second\r\n").context("cannot do it");
        assert_eq!(one_line(&error), "cannot do it: first; second");
    }
}
