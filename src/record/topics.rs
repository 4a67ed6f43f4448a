//! Which topics are meant: patterns with `*` (within one level) and `**` (any number of levels), as Zenoh has them.

/// A choice of topics; no pattern means all.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Topics {
    patterns: Vec<String>,
}

impl Topics {
    /// Topics that match one of `patterns`: the whole topic, or what stands behind the base `sandgate/v1/NAME/`.
    #[must_use]
    pub fn new(patterns: &[String]) -> Self {
        Self {
            patterns: patterns.to_vec(),
        }
    }

    /// Whether a topic is among them.
    #[must_use]
    pub fn has(&self, topic: &str) -> bool {
        let matches = |pattern: &String| {
            level_match(pattern, topic) || level_match(pattern, below_base(topic))
        };
        self.patterns.is_empty() || self.patterns.iter().any(matches)
    }
}

/// What stands behind `sandgate/v1/NAME/`; the topic itself if it has no such base.
#[must_use]
pub fn below_base(topic: &str) -> &str {
    topic.splitn(4, '/').nth(3).unwrap_or(topic)
}

fn level_match(pattern: &str, topic: &str) -> bool {
    let pattern: Vec<&str> = pattern.split('/').collect();
    let topic: Vec<&str> = topic.split('/').collect();
    levels(&pattern, &topic)
}

fn levels(pattern: &[&str], topic: &[&str]) -> bool {
    match pattern.split_first() {
        None => topic.is_empty(),
        Some((&"**", rest)) => (0..=topic.len()).any(|skip| levels(rest, &topic[skip..])),
        Some((first, rest)) => topic
            .split_first()
            .is_some_and(|(level, others)| text(first, level) && levels(rest, others)),
    }
}

/// One level; `*` stands for any text.
fn text(pattern: &str, level: &str) -> bool {
    match pattern.split_once('*') {
        None => pattern == level,
        Some((head, tail)) => level.strip_prefix(head).is_some_and(|rest| {
            let mut ends = rest.char_indices().map(|(at, _)| at).chain([rest.len()]);
            ends.any(|at| text(tail, &rest[at..]))
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_choose_topics_by_level() {
        let topic = "sandgate/v1/silo/out/gauge/level.depth";
        let has = |pattern: &str| Topics::new(&[pattern.to_owned()]).has(topic);
        for yes in [
            "**",
            "out/**",
            "out/gauge/*",
            "out/*/level.*",
            "**/level.depth",
            topic,
            "sandgate/*/silo/**",
        ] {
            assert!(has(yes), "{yes}");
        }
        for no in [
            "out/*",
            "gauge/*",
            "out/gauge/level",
            "*",
            "out/gauge/*.dep",
            "",
        ] {
            assert!(!has(no), "{no}");
        }
        assert!(Topics::default().has(topic));
    }
}
