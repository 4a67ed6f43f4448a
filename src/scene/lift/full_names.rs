//! Names with what they are names of: `gate.main`, `inflow.feed.rate`. Where one is wrong those that there are are told.

use super::Lift;
use crate::scene::raw::{At, Named, Place, nearest};
use crate::units::quote;

/// Most names that a message lists.
const MOST: usize = 12;

/// Of a section's entries, with `of` before and `what` behind their names.
pub(super) fn full_names<T>(of: &str, entries: Option<&At<Named<T>>>, what: &str) -> Vec<String> {
    let entries = entries.into_iter().flat_map(|e| &e.value.0);
    entries.map(|e| format!("{of}.{}{what}", e.name)).collect()
}

impl Lift<'_> {
    /// Reports text that is no full name of the form `allowed`, with the one of `known` that was probably meant.
    pub(super) fn report_full_name(
        &mut self,
        place: &Place,
        text: &str,
        (allowed, example): (&str, &str),
        known: &[String],
    ) {
        // A name alone, or with another first or last part, is meant before one that is spelt alike.
        let parts: Vec<&str> = text.split('.').collect();
        let named = |full: &&String| full.split('.').nth(1).is_some_and(|n| parts.contains(&n));
        let mut same = known.iter().filter(named);
        let meant = match (same.next(), same.next()) {
            (Some(one), None) => Some(one.as_str()),
            _ => nearest(text, known.iter().map(String::as_str)),
        };
        let listed = known.iter().take(MOST).map(|name| quote(name));
        let listed: Vec<String> = listed.collect();
        let more = if known.len() > MOST { ", ..." } else { "" };
        let allowed = match listed.is_empty() {
            true => format!("{allowed}, but there is none"),
            false => format!("{allowed}: {}{more}", listed.join(", ")),
        };
        let remedy = match meant {
            Some(meant) => format!("did you mean {}?", quote(meant)),
            None if known.is_empty() => format!("write for example {}", quote(example)),
            None => "choose one of these".to_owned(),
        };
        let found = format!("text {}", quote(text));
        self.problems.report(place, found, allowed, remedy);
    }
}
