//! What a run's figures say of its scene, in words for people.

use super::session::Session;
use super::summary::extremes;

/// A larger share of fast mass than that of single splashes is worth a word.
const MUCH: f64 = 0.05;

/// Lines under the table of a run.
pub(super) fn notes(session: &Session) -> Vec<String> {
    fast(session).into_iter().collect()
}

/// The sound speed is too low for what flowed.
fn fast(session: &Session) -> Option<String> {
    let (_, (share, time)) = extremes(session, "validity.share_fast")?;
    (share > MUCH).then(|| {
        let time = (1e6 * time).round() / 1e6;
        format!(
            "note: at t = {time} s {:.0} % of the mass under pressure moved faster than a fifth of the sound speed\n  \
             (numerics.sound_speed, {:.3} m/s here): so fast it is compressed by its own flow, and thin layers may gain speed.\n  \
             Give numerics.expected_speed, the largest speed that you expect, or a larger numerics.sound_speed; the run takes\n  \
             longer in proportion. See validity.share_fast over time, and docs/theory.md, \"Limits\".",
            100.0 * share,
            session.component.scene().numerics.sound_speed,
        )
    })
}
