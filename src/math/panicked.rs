//! What a panic said, for those who turn it into an error of theirs.

use std::any::Any;

/// The text of a panic, from what catching it gave; "panic" if it was no text.
#[must_use]
pub fn panic_text(payload: &(dyn Any + Send)) -> String {
    let borrowed = payload
        .downcast_ref::<&str>()
        .map(|text| (*text).to_owned());
    borrowed
        .or_else(|| payload.downcast_ref::<String>().cloned())
        .unwrap_or_else(|| "panic".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_says_what_it_was_given() {
        let said = |payload: Box<dyn Any + Send>| panic_text(payload.as_ref());
        assert_eq!(said(Box::new("as it stands")), "as it stands");
        assert_eq!(said(Box::new(format!("made of {}", 2))), "made of 2");
        assert_eq!(said(Box::new(7)), "panic");
    }
}
