//! Keys: Zenoh key expressions, which are also the topics of log files (but frames share one topic there).
//!
//! All are below a base `<root>/v1/<instance>`. A variable's name is a group and the rest, split at the first dot:
//! the output `gauge.weir.depth` is published at `<base>/out/gauge/weir.depth`; the input `gate.main.opening` is set at
//! `<base>/in/gate.main.opening`.

/// Root unless somebody says otherwise.
pub const ROOT: &str = "sandgate";

/// Why a name cannot be used in keys.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("instance name: found {found:?}, allowed are 1 to 64 of a-z 0-9 _ -; choose another name")]
pub struct BadInstance {
    /// What was found.
    pub found: String,
}

/// The base of all keys: `<root>/v1/<instance>`.
///
/// # Errors
/// [`BadInstance`] unless the instance is 1 to 64 of `a-z 0-9 _ -`.
pub fn base(root: &str, instance: &str) -> Result<String, BadInstance> {
    let allowed = |b: u8| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'_' || b == b'-';
    if (1..=64).contains(&instance.len()) && instance.bytes().all(allowed) {
        Ok(format!("{root}/v1/{instance}"))
    } else {
        Err(BadInstance {
            found: instance.to_owned(),
        })
    }
}

/// Key of an output variable: [`Gauge`](super::messages::Gauge).
#[must_use]
pub fn output(base: &str, variable: &str) -> String {
    format!("{base}/out/{}", variable.replacen('.', "/", 1))
}

/// Key at which an input variable is set.
#[must_use]
pub fn input(base: &str, variable: &str) -> String {
    format!("{base}/in/{variable}")
}

/// Key of [`Applied`](super::messages::Applied).
#[must_use]
pub fn applied(base: &str) -> String {
    format!("{base}/out/applied")
}

/// Key of [`StepStats`](super::messages::StepStats).
#[must_use]
pub fn stats(base: &str) -> String {
    format!("{base}/out/stats")
}

/// Key of [`Log`](super::foxglove::Log).
#[must_use]
pub fn log(base: &str) -> String {
    format!("{base}/out/log")
}

/// Key of [`PointCloud`](super::foxglove::PointCloud).
#[must_use]
pub fn particles(base: &str) -> String {
    format!("{base}/out/particles")
}

/// Key of [`SceneUpdate`](super::foxglove::SceneUpdate): walls and gates, each gate and moving wall in a frame of its own.
#[must_use]
pub fn scene(base: &str) -> String {
    format!("{base}/out/scene")
}

/// Key of the [`FrameTransform`](super::foxglove::FrameTransform) of one frame (`gate.NAME`, `wall.NAME`): where it is. A key
/// of its own, so that the last value of each can be asked for.
#[must_use]
pub fn frame(base: &str, name: &str) -> String {
    format!("{base}/out/frames/{name}")
}

/// Topic of all [`FrameTransform`](super::foxglove::FrameTransform)s in logs.
#[must_use]
pub fn frames(base: &str) -> String {
    format!("{base}/out/frames")
}

/// Key of a request: of calls over Zenoh (`interface` "rpc") and, in logs, of those of other interfaces.
#[must_use]
pub fn control(base: &str, interface: &str, verb: &str) -> String {
    format!("{base}/@{interface}/{verb}")
}

/// What may be asked over the bus. Calls of other names share one topic of a log: whoever can ask must not be able to give
/// it topics without end.
pub const VERBS: [&str; 12] = [
    "describe",
    "status",
    "get",
    "set",
    "step",
    "run",
    "pause",
    "reset",
    "save",
    "restore",
    "log",
    "terminate",
];

/// Topic of a call in logs, to which `/request` or `/reply` is added: its key, that of all verbs that there are not, or that of
/// all set-points (`interface` "in").
#[must_use]
pub fn logged_call(base: &str, interface: &str, verb: &str) -> String {
    match interface {
        "rpc" if !VERBS.contains(&verb) => control(base, interface, "unknown"),
        "in" => control(base, interface, "set-point"),
        _ => control(base, interface, verb),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_those_of_the_table() {
        let base = base(ROOT, "silo_gate").unwrap();
        assert_eq!(base, "sandgate/v1/silo_gate");
        assert_eq!(
            output(&base, "gauge.weir.depth"),
            "sandgate/v1/silo_gate/out/gauge/weir.depth"
        );
        assert_eq!(
            input(&base, "gate.main.opening"),
            "sandgate/v1/silo_gate/in/gate.main.opening"
        );
        assert_eq!(
            frame(&base, "gate.main"),
            "sandgate/v1/silo_gate/out/frames/gate.main"
        );
        assert_eq!(
            control(&base, "rpc", "step"),
            "sandgate/v1/silo_gate/@rpc/step"
        );
        for (interface, verb, topic) in [
            ("rpc", "step", "@rpc/step"),
            ("rpc", "stepp", "@rpc/unknown"),
            ("rpc", "step/now", "@rpc/unknown"),
            ("in", "gate.main.opening", "@in/set-point"),
            ("c", "sandgate_step", "@c/sandgate_step"),
        ] {
            let topic = format!("sandgate/v1/silo_gate/{topic}");
            assert_eq!(logged_call(&base, interface, verb), topic);
        }
    }

    #[test]
    fn names_that_would_break_keys_are_refused() {
        for bad in ["", "Silo", "a/b", "a*", "a b", "ä", "$", &"x".repeat(65)] {
            let error = base(ROOT, bad).unwrap_err().to_string();
            assert!(error.contains("a-z 0-9 _ -"), "{error}");
        }
        assert!(base(ROOT, &"x".repeat(64)).is_ok());
    }
}
