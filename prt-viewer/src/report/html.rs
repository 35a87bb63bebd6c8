//! Text inside a page.

use std::borrow::Cow;

/// Text with everything that means something to HTML or XML replaced, fit for contents and for attributes in double quotes.
///
/// Characters that neither allows, such as control characters in a file name, become `U+FFFD`.
pub(super) fn escape(text: &str) -> Cow<'_, str> {
    let is_plain = |c: char| !matches!(c, '<' | '>' | '&' | '"' | '\'') && is_allowed(c);
    if text.chars().all(is_plain) {
        return Cow::Borrowed(text);
    }
    let mut escaped = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        match c {
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '&' => escaped.push_str("&amp;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            c if is_allowed(c) => escaped.push(c),
            _ => escaped.push(char::REPLACEMENT_CHARACTER),
        }
    }
    Cow::Owned(escaped)
}

/// XML 1.0, production `Char`.
fn is_allowed(c: char) -> bool {
    matches!(c, '\t' | '\n' | '\r' | '\u{20}'..='\u{d7ff}' | '\u{e000}'..='\u{fffd}' | '\u{1_0000}'..)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_of_a_name_is_markup() {
        assert_eq!(escape("a<&>\"'b"), "a&lt;&amp;&gt;&quot;&#39;b");
        assert_eq!(escape("plain, ü 日本"), "plain, ü 日本");
        assert_eq!(escape("a\u{1b}[1m\0\u{fffe}"), "a\u{fffd}[1m\u{fffd}\u{fffd}");
    }
}
