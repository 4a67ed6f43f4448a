//! Legal scenes with one illegal value: each must be refused, and say why.

use toml::Value;

use super::super::Expect;
use super::super::dice::Dice;
use super::{Draft, devices, free, plane, rings, space};
use crate::validate::template::Template;

/// Keys and values that no scene may have.
fn values() -> Vec<(&'static str, Value)> {
    let floats = [
        ("numerics.spacing", -0.01),
        ("numerics.spacing", 0.0),
        ("numerics.spacing", f64::NAN),
        ("numerics.spacing", f64::INFINITY),
        ("numerics.smoothing_ratio", 3.0),
        ("numerics.smoothing_ratio", 0.5),
        ("numerics.courant", 0.0),
        ("numerics.courant", 1.5),
        ("numerics.sound_speed", -1.0),
        ("numerics.cap_time", 0.0),
        ("numerics.cap_time", f64::INFINITY),
        ("numerics.density_diffusion", -0.1),
        ("numerics.pair_viscosity_share", 2.0),
        ("numerics.solver_tolerance", 0.0),
        ("numerics.jitter", 0.9),
        ("numerics.strain_relaxation_time", -1.0),
        ("domain.gravity", f64::NAN),
        ("domain.width", 0.0),
        ("run.step", 0.0),
        ("run.step", f64::NAN),
        ("run.until", -1.0),
        ("bodies.no_such.level", 1.0),
        ("materials.more.friction_angle", 2.0),
        ("walls.nowhere.wall_friction", 0.5),
    ];
    let texts = [
        ("numerics.spacing", "5 kg"),
        ("numerics.spacing", "five"),
        ("numerics.yield", "sometimes"),
        ("numerics.scheme", "explicit"),
        ("numerics.speling", "1 mm"),
        ("domain.slope", "91 deg"),
        ("dimension", "four"),
        ("name", "Not A Name"),
        ("materials.more.law", "snow"),
    ];
    let float = floats.map(|(key, value)| (key, Value::Float(value)));
    let text = texts.map(|(key, value)| (key, Value::String(value.to_owned())));
    let others = [
        ("numerics.sleep", Value::Integer(3)),
        ("numerics.seed", Value::Float(1.5)),
        ("numerics", Value::Boolean(true)),
        ("domain.upper", Value::Array(vec![Value::Float(1.0)])),
        ("schedule", Value::Array(vec![Value::Integer(1)])),
    ];
    float.into_iter().chain(text).chain(others).collect()
}

/// A scene of another kind with one of them.
pub(super) fn illegal(dice: &mut Dice) -> Draft {
    let make: super::Make = dice.pick(&[
        plane::column as super::Make,
        devices::chute,
        free::free,
        rings::column,
        space::heap,
    ]);
    let mut draft = make(dice);
    let values = values();
    let (key, value) = &values[dice.whole(0, values.len() - 1)];
    if let Ok(template) = Template::new(&draft.scene)
        && let Ok(text) = template.with(key, value.clone()).text()
    {
        draft.scene = text;
    }
    draft.drive.expect = Expect::Refusal;
    draft.drive.note = format!("{key} = {value}");
    draft
}
