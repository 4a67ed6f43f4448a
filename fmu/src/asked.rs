//! What a call was asked, for its log: arguments that stand nowhere else once it was refused.

use std::borrow::Cow;

/// Arguments of a call.
#[cfg_attr(
    not(feature = "record"),
    expect(dead_code, reason = "only a log reads them")
)]
pub(crate) enum Asked<'a> {
    /// None, or such as are too large for a log.
    Nothing,
    /// Variables to read, or to set in vain.
    Variables(&'a [u32]),
    /// Texts to set.
    Texts(&'a [u32], &'a [&'a str]),
    /// The name of a variable.
    Name(&'a str),
    /// A number of threads.
    Threads(u32),
    /// Start and stop time [s].
    Times(f64, Option<f64>),
}

/// A text that was set, as messages and logs may show it: Zenoh's configuration may hold a password.
pub(crate) fn shown<'a>(name: &str, text: &'a str) -> Cow<'a, str> {
    if name == "zenoh.config" && text.contains('{') {
        return format!("{{{} characters}}", text.chars().count()).into();
    }
    text.into()
}

#[cfg(test)]
mod tests {
    use super::shown;

    #[test]
    fn a_password_in_a_configuration_is_shown_nowhere() {
        let json = r#"{transport: {auth: {usrpwd: {user: "plc", password: "geheim"}}}}"#;
        assert_eq!(shown("zenoh.config", json), "{64 characters}");
        let commented = format!("// ours\n{json}");
        assert_eq!(shown("zenoh.config", &commented), "{72 characters}");
        assert_eq!(
            shown("zenoh.config", "/etc/zenoh.json5"),
            "/etc/zenoh.json5"
        );
        assert_eq!(shown("log.path", "{run}.mcap"), "{run}.mcap");
    }
}
