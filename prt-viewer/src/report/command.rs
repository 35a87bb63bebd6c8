//! The command that repeats a bake.

use std::ffi::OsString;

/// The program `prt` with arguments, quoted for a POSIX shell.
///
/// - `arguments`: those of the process, with the name of the program first, which is left out
pub(crate) fn command_line(arguments: impl IntoIterator<Item = OsString>) -> String {
    let quoted = arguments.into_iter().skip(1).map(|argument| quote(&argument.to_string_lossy()));
    std::iter::once("prt".to_owned()).chain(quoted).collect::<Vec<_>>().join(" ")
}

/// A word as it is if no shell gives a meaning to it, otherwise between single quotes.
fn quote(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./,:=+@%".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_survive_a_shell() {
        let words = ["/usr/bin/prt", "bake", "my scene.obj", "-o", "it's <&>.prt", "--albedo=0.5,0.5,1", "", "$HOME"];
        assert_eq!(
            command_line(words.map(OsString::from)),
            r"prt bake 'my scene.obj' -o 'it'\''s <&>.prt' --albedo=0.5,0.5,1 '' '$HOME'"
        );
    }
}
