//! Where an instance is found, in words for people and for the programs that read them.

use std::fmt;

/// How an instance is reached.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Reach {
    /// Endpoints that it listens on, with real ports: `tcp/127.0.0.1:40123`.
    pub listeners: Vec<String>,
    /// Routers or peers through which others find it.
    pub through: Vec<String>,
    /// Why none of `through` answered yet: they are looked for.
    pub unanswered: Option<String>,
}

impl Reach {
    /// One line a place: `listening on ENDPOINT`, `reached through ENDPOINT`.
    #[must_use]
    pub fn lines(&self) -> Vec<String> {
        let listening = self.listeners.iter().map(|e| format!("listening on {e}"));
        let through = self.through.iter().map(|e| match &self.unanswered {
            None => format!("reached through {e}"),
            Some(why) => format!("looking for {e}, which does not answer yet ({why})"),
        });
        listening.chain(through).collect()
    }
}

impl fmt::Display for Reach {
    /// All in one line.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (listeners, mut parts) = (self.listeners.join(", "), self.lines());
        if !listeners.is_empty() {
            let rest = parts.split_off(self.listeners.len());
            parts = vec![format!("listening on {listeners}")];
            parts.extend(rest);
        }
        f.write_str(&parts.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_says_where_it_is_found() {
        let mut reach = Reach {
            listeners: vec!["tcp/a:1".to_owned(), "tcp/b:2".to_owned()],
            ..Reach::default()
        };
        assert_eq!(reach.to_string(), "listening on tcp/a:1, tcp/b:2");
        reach.through.push("tcp/c:3".to_owned());
        assert_eq!(
            reach.lines(),
            [
                "listening on tcp/a:1",
                "listening on tcp/b:2",
                "reached through tcp/c:3"
            ]
        );
        reach.listeners.clear();
        assert_eq!(reach.to_string(), "reached through tcp/c:3");
        reach.unanswered = Some("no route".to_owned());
        assert_eq!(
            reach.to_string(),
            "looking for tcp/c:3, which does not answer yet (no route)"
        );
    }
}
