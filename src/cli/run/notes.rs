//! What a run's figures say of its scene, in words for people.

use super::columns::Figures;
use super::session::Session;
use super::summary::{extremes, short};
use crate::cli::remarks::remarks;
use crate::gauge::Validity;
use crate::scene::{Inflow, InputTarget, Scene};

/// A larger share of fast mass than that of single splashes is worth a word, and of the time in which a gate stood still.
const MUCH: f64 = 0.05;

/// A smaller share of what an inflow was to let in is not worth one.
const LITTLE: f64 = 0.01;

/// Lines under the table of a run.
pub(super) fn notes(session: &Session) -> Vec<String> {
    let scene = session.component.scene();
    let (table, series) = (session.component.variables(), &session.series);
    let figures = |variable| series.column(variable).and_then(|column| column.figures);
    let blocked = scene.inflows.iter().enumerate().filter_map(|(i, inflow)| {
        let rate = figures(table.input(InputTarget::InflowRate(i)))?;
        blocked(
            inflow,
            scene.numerics.spacing,
            &rate,
            &figures(table.inflow_mass(i))?,
        )
    });
    let held = scene
        .gates
        .iter()
        .zip(&series.gates)
        .filter_map(|(gate, columns)| {
            let (start, end) = series.span?;
            let stood = series.columns[columns.blocked].figures?.over_time;
            held(&gate.name, end - start, stood, columns.last_blocked?)
        });
    fast(session)
        .into_iter()
        .chain(squeezed(session))
        .chain(blocked)
        .chain(held)
        .chain(scene.gauges.iter().filter_map(|gauge| {
            let flag = format!("gauge.{}.validity", gauge.name);
            let column = series.columns.iter().find(|c| c.name == flag)?;
            silent(&gauge.name, &column.figures?)
        }))
        .chain(remarks(scene))
        .collect()
}

/// An inflow let in less than was wanted, by more than the rows that are always on their way. `rate` is what held over each
/// step, `mass` what had come in by its end.
fn blocked(inflow: &Inflow, spacing: f64, rate: &Figures, mass: &Figures) -> Option<String> {
    let wanted = rate.over_time;
    let admitted = mass.last - mass.first;
    // The face passes max_rate at this speed, a row each spacing of the way; a slanting row is heavier, if by less than 2.
    let speed = inflow.velocity.iter().map(|v| v * v).sum::<f64>().sqrt();
    let row = inflow.max_rate * spacing / speed;
    let lost = wanted - admitted;
    (lost > 2.0 * row && lost > LITTLE * wanted).then(|| {
        format!(
            "note: inflow.{} let in {} of {} kg wanted; it was blocked by what stands before its face:\n  \
             a fluid let in through a wall needs room to push it into, anything else a spacing of free room;\n  \
             put it above the surface, or make it higher than what stands before it.",
            inflow.name,
            short(admitted),
            short(wanted)
        )
    })
}

/// A gate could not close as it was told to: it `stood` for so long of the `whole` run [s], at last when it was told to go to
/// `wanted` and was at `opening`.
fn held(name: &str, whole: f64, stood: f64, (wanted, opening): (f64, f64)) -> Option<String> {
    (stood > MUCH * whole).then(|| {
        format!(
            "note: gate.{name} was told to close to {} and was blocked for {} of {} s: material stood in its way, and it came\n  \
             to {}. See gate.{name}.blocked over time.",
            short(wanted),
            short(stood),
            short(whole),
            short(opening),
        )
    })
}

/// A gauge that measured at no time: `flag` is its validity.
fn silent(name: &str, flag: &Figures) -> Option<String> {
    let outside = f64::from(Validity::Outside.code());
    if flag.low.0 >= f64::from(Validity::Empty.code()) && flag.low.0 < outside {
        return Some(format!(
            "note: gauge.{name} read 0 all the time: no material came to its place (validity 1). If some should have, see where its\n  \
             line or point lies; docs/gauges.md says what each gauge needs."
        ));
    }
    (flag.low.0 >= outside).then(|| {
        let place = match flag.last > outside {
            true => "within a wall or a gate",
            false => "outside of the domain",
        };
        format!(
            "note: gauge.{name} read 0 all the time and measured nothing: its place was {place} (validity {}).\n  \
             Move it to where material comes; docs/gauges.md says what each gauge needs.",
            flag.last
        )
    })
}

/// Sound speeds by their keys: the scene's, and those of materials that have a lower one.
fn sound_speeds(scene: &Scene) -> String {
    let mut all = vec![format!(
        "numerics.sound_speed, {:.3} m/s here",
        scene.numerics.sound_speed
    )];
    for named in &scene.materials {
        if let Some(own) = named.material.sound_speed {
            all.push(format!(
                "materials.{}.sound_speed, {own:.3} m/s",
                named.name
            ));
        }
    }
    all.join("; ")
}

/// What to do for a larger sound speed: the key that sets it wins over the one that it else follows from.
fn raise_sound_speed(scene: &Scene) -> &'static str {
    let text = toml::from_str::<toml::Table>(&scene.source).unwrap_or_default();
    let numerics = text.get("numerics").and_then(toml::Value::as_table);
    let gives = |key: &str| numerics.is_some_and(|keys| keys.contains_key(key));
    if gives("grain_compressibility") {
        "Lower numerics.grain_compressibility, from which it follows here"
    } else if gives("sound_speed") {
        "Raise sound_speed, or delete it and give numerics.expected_speed, the largest speed that you expect"
    } else {
        "Give numerics.expected_speed, the largest speed that you expect, or a larger sound_speed"
    }
}

/// The sound speed is too low for what flowed.
fn fast(session: &Session) -> Option<String> {
    let (_, (share, time)) = extremes(session, session.component.variables().share_fast())?;
    (share > MUCH).then(|| {
        let time = (1e6 * time).round() / 1e6;
        format!(
            "note: at t = {time} s {:.0} % of the mass under pressure moved faster than a fifth of the sound speed\n  \
             ({}): so fast it is compressed by its own flow, and thin layers may gain speed.\n  \
             {}; the run takes\n  \
             longer in proportion. See validity.share_fast over time, and docs/limits.md.",
            100.0 * share,
            sound_speeds(session.component.scene()),
            raise_sound_speed(session.component.scene()),
        )
    })
}

/// More was squeezed than what an impact squeezes for a moment.
fn squeezed(session: &Session) -> Option<String> {
    let (_, (share, time)) = extremes(session, session.component.variables().share_squeezed())?;
    (share > MUCH).then(|| {
        let time = (1e6 * time).round() / 1e6;
        format!(
            "note: at t = {time} s {:.0} % of the mass under pressure was squeezed by more than a twentieth\n  \
             ({}), where grains or water would not have given way: forces and pressures are those of a spring.\n  \
             Leave it room to go where a wall or a gate moves into it, or give a larger sound_speed; the run takes\n  \
             longer in proportion. See validity.share_squeezed over time, and docs/limits.md.",
            100.0 * share,
            sound_speeds(session.component.scene()),
        )
    })
}

#[cfg(test)]
mod tests {
    use super::super::columns::GateColumns;
    use super::*;

    /// 10 kg/s at most, 1 kg a row.
    fn inflow() -> Inflow {
        Inflow {
            name: "in".to_owned(),
            material: 0,
            from: [0.0, 0.1, 0.0],
            to: [0.0; 3],
            span: [0.0; 3],
            velocity: [0.1, 0.0, 0.0],
            rate: 0.0,
            max_rate: 10.0,
        }
    }

    /// What rows at these times come to.
    fn figures(time: &[f64], values: &[f64]) -> Figures {
        let mut figures = Figures::of(time[0], values[0]);
        for (times, value) in time.windows(2).zip(&values[1..]) {
            figures.add(times[1], times[1] - times[0], *value);
        }
        figures
    }

    fn note(rate: &[f64], mass: &[f64]) -> Option<String> {
        let of = |values| figures(&[0.0, 1.0, 3.0], values);
        blocked(&inflow(), 0.01, &of(rate), &of(mass))
    }

    #[test]
    fn an_inflow_that_was_blocked_is_told_with_what_was_wanted() {
        // The rate of the first row held over no step.
        let told = note(&[9.0, 3.0, 1.0], &[0.0, 0.0, 1.0]).unwrap();
        assert!(told.contains("inflow.in let in 1 of 5 kg wanted"), "{told}");
        assert!(told.contains("a spacing of free room"), "{told}");
        assert!(told.contains("above the surface"), "{told}");
    }

    #[test]
    fn a_gate_that_was_held_for_long_is_told_with_what_it_was_told_to_do() {
        let time = [0.0, 1.0, 3.0, 4.0];
        let (wanted, opening) = ([1.0, 0.25, 0.25, 1.0], [1.0, 0.5, 0.4, 1.0]);
        let note = |blocked: &[f64; 4]| {
            let mut gate = GateColumns {
                opening: 0,
                actual_opening: 1,
                blocked: 2,
                last_blocked: None,
            };
            for row in 0..4 {
                gate.see(&[wanted[row], opening[row], blocked[row]]);
            }
            let stood = figures(&time, blocked).over_time;
            held("main", 4.0, stood, gate.last_blocked?)
        };
        let told = note(&[0.0, 0.0, 1.0, 0.0]).unwrap();
        for part in [
            "gate.main was told to close to 0.25",
            "blocked for 2 of 4 s",
            "to 0.4.",
        ] {
            assert!(told.contains(part), "{told}");
        }
        // What holds at the start held over no step.
        assert_eq!(note(&[1.0, 0.0, 0.0, 0.0]), None);
        assert_eq!(note(&[0.0; 4]), None);
    }

    #[test]
    fn a_gauge_that_never_measured_is_told_with_why() {
        let note = |flags: &[f64]| silent("level", &figures(&[0.0, 1.0, 3.0], flags));
        let told = note(&[3.0, 3.0, 3.0]).unwrap();
        assert!(told.contains("gauge.level read 0 all the time"), "{told}");
        assert!(
            told.contains("within a wall or a gate (validity 3)"),
            "{told}"
        );
        assert!(note(&[2.0; 3]).unwrap().contains("outside of the domain"));
        // A gate may cover a place for a while, and material may come late.
        for empty in [[1.0; 3], [1.0, 3.0, 1.0]] {
            let told = note(&empty).unwrap();
            assert!(told.contains("no material came to its place"), "{told}");
        }
        assert_eq!(note(&[3.0, 0.0, 3.0]), None);
        assert_eq!(note(&[1.0, 1.0, 0.0]), None);
    }

    #[test]
    fn what_raises_the_sound_speed_is_the_key_that_sets_it() {
        let stream = include_str!("../../../tests/scenes/stream.toml");
        for (given, key) in [
            ("sound_speed = 10", "Raise sound_speed, or delete it"),
            ("expected_speed = 1", "Give numerics.expected_speed"),
            (
                "grain_compressibility = 1e-5",
                "Lower numerics.grain_compressibility",
            ),
        ] {
            let text = stream.replace("sound_speed = 10", given);
            let scene = crate::scene::parse("stream", &text).unwrap();
            let told = raise_sound_speed(&scene);
            assert!(told.starts_with(key), "{given}: {told}");
        }
    }

    #[test]
    fn an_inflow_that_is_a_row_behind_is_not_told() {
        assert_eq!(note(&[3.0, 3.0, 1.0], &[0.0, 3.0, 4.0]), None);
        assert_eq!(note(&[0.0, 0.0, 0.0], &[0.0, 0.0, 0.0]), None);
        assert_eq!(note(&[0.0, 6.0, 0.0], &[7.0, 12.5, 12.5]), None);
    }
}
