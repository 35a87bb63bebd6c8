//! Where runs leave their tables: on the terminal, and as CSV under `target/repro`.

use std::path::PathBuf;

use anyhow::{Context, Result};

/// Prints a table in Markdown, and writes it as `target/repro/NAME.csv`.
pub(crate) fn table(name: &str, head: &[&str], rows: &[Vec<String>]) -> Result<()> {
    print(markdown(head, rows).trim_end());
    let path = folder()?.join(format!("{}.csv", name.replace('/', "-")));
    let lines: Vec<String> =
        std::iter::once(head.join(",")).chain(rows.iter().map(|row| row.join(",").replace("**", ""))).collect();
    std::fs::write(&path, lines.join("\n") + "\n").with_context(|| format!("cannot write {}", path.display()))
}

/// A table in Markdown.
pub(crate) fn markdown(head: &[&str], rows: &[Vec<String>]) -> String {
    let rule = format!("|{}\n", "---|".repeat(head.len()));
    let body: String = rows.iter().map(|row| format!("| {} |\n", row.join(" | "))).collect();
    format!("| {} |\n{rule}{body}", head.join(" | "))
}

/// Writes `target/repro/NAME`.
pub(crate) fn file(name: &str, contents: &str) -> Result<()> {
    let path = folder()?.join(name.replace('/', "-"));
    std::fs::write(&path, contents).with_context(|| format!("cannot write {}", path.display()))
}

fn folder() -> Result<PathBuf> {
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| PathBuf::from("target"), PathBuf::from);
    let folder = target.join("repro");
    std::fs::create_dir_all(&folder).with_context(|| format!("cannot create {}", folder.display()))?;
    Ok(folder)
}

#[expect(clippy::print_stdout, reason = "the answer of the program")]
fn print(line: &str) {
    println!("{line}");
}
