//! Writes XML and HTML text: elements with attributes, escaped. Knows no schema.

use std::fmt::{Display, Write};

/// Text with everything that means something in XML escaped; line breaks and other control characters become spaces, as do the
/// two of the first plane that no document may hold.
pub(super) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\u{FFFE}' | '\u{FFFF}' => out.push(' '),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

/// A number as xs:double, shortest form that reads back to the same bits.
pub(super) fn number(value: f64) -> String {
    format!("{value:?}")
}

/// A document under construction: two spaces of indent for each open element.
#[derive(Default)]
pub(super) struct Xml {
    text: String,
    open: Vec<&'static str>,
}

/// Attributes in the order given.
pub(super) type Attributes = Vec<(&'static str, String)>;

impl Xml {
    pub(super) fn document() -> Self {
        Self {
            text: "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n".to_owned(),
            open: Vec::new(),
        }
    }

    /// `<name attributes>`, closed by [`Xml::end`].
    pub(super) fn begin(&mut self, name: &'static str, attributes: &Attributes) {
        self.tag(name, attributes, ">");
        self.open.push(name);
    }

    /// `<name attributes/>`.
    pub(super) fn leaf(&mut self, name: &'static str, attributes: &Attributes) {
        self.tag(name, attributes, "/>");
    }

    /// Closes the element opened last.
    pub(super) fn end(&mut self) {
        if let Some(name) = self.open.pop() {
            self.indent();
            self.push(format_args!("</{name}>\n"));
        }
    }

    pub(super) fn finish(mut self) -> String {
        while !self.open.is_empty() {
            self.end();
        }
        self.text
    }

    fn tag(&mut self, name: &str, attributes: &Attributes, close: &str) {
        self.indent();
        self.push(format_args!("<{name}"));
        for (key, value) in attributes {
            self.push(format_args!(" {key}=\"{}\"", escape(value)));
        }
        self.push(format_args!("{close}\n"));
    }

    fn indent(&mut self) {
        for _ in &self.open {
            self.text.push_str("  ");
        }
    }

    fn push(&mut self, what: impl Display) {
        // Writing to a String cannot fail.
        let _ = write!(self.text, "{what}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_escaped_and_elements_closed() {
        let mut xml = Xml::document();
        xml.begin("a", &vec![("t", "<\"&\">\nü".to_owned())]);
        xml.leaf("b", &vec![]);
        assert_eq!(
            xml.finish(),
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
             <a t=\"&lt;&quot;&amp;&quot;&gt; ü\">\n  <b/>\n</a>\n"
        );
    }

    /// Production 2 of XML 1.0: `Char`.
    #[test]
    fn no_character_that_a_document_may_not_hold_gets_through() {
        let all: String = ('\0'..=char::MAX).collect();
        let allowed = |c| matches!(c, '\t' | '\n' | '\r' | ' '..='\u{D7FF}' | '\u{E000}'..='\u{FFFD}' | '\u{10000}'..);
        let found = escape(&all).chars().find(|c| !allowed(*c));
        assert_eq!(found, None);
        assert_eq!(escape("a\u{FFFE}b\u{FFFF}c\u{FFFD}"), "a b c\u{FFFD}");
    }

    #[test]
    fn numbers_read_back_to_the_same_bits() {
        for value in [0.1, 1e-300, 1e300, 5.0, -0.0, f64::MAX, f64::MIN_POSITIVE] {
            let back: f64 = number(value).parse().expect("a number");
            assert_eq!(back.to_bits(), value.to_bits());
        }
    }
}
