//! The scheme: which keys of [numerics] it uses, and what the reference schemes share.

use super::Lift;
use super::paper_b::paper_b;
use crate::scene::raw::{At, Place, RawNumerics, RawWall, SchemeWord};
use crate::scene::types::NamedMaterial;
use crate::solver::Scheme;

/// What to do about what a reference scheme does not support.
pub(super) const REMEDY: &str = "delete it, or choose scheme = \"implicit\"";

/// Keys of [numerics] that not every scheme uses: which do, and where the key stands.
type Key<'r> = (&'static str, &'static [SchemeWord], Option<&'r Place>);

const IMPLICIT: &[SchemeWord] = &[SchemeWord::Implicit];
const PAPER_A: &[SchemeWord] = &[SchemeWord::PaperA];
const PAPER_B: &[SchemeWord] = &[SchemeWord::PaperB];
const DIFFUSIVE: &[SchemeWord] = &[SchemeWord::Implicit, SchemeWord::PaperB];
const ARTIFICIAL: &[SchemeWord] = &[SchemeWord::Implicit, SchemeWord::PaperA];

fn keys(raw: &RawNumerics) -> Vec<Key<'_>> {
    vec![
        ("acoustic_steps", IMPLICIT, place(&raw.acoustic_steps)),
        ("yield", IMPLICIT, place(&raw.r#yield)),
        ("yield_iterations", IMPLICIT, place(&raw.yield_iterations)),
        ("cap_time", IMPLICIT, place(&raw.cap_time)),
        (
            "density_diffusion",
            DIFFUSIVE,
            place(&raw.density_diffusion),
        ),
        (
            "diffusion_gate_time",
            IMPLICIT,
            place(&raw.diffusion_gate_time),
        ),
        (
            "strain_relaxation_time",
            IMPLICIT,
            place(&raw.strain_relaxation_time),
        ),
        (
            "friction_into_walls",
            IMPLICIT,
            place(&raw.friction_into_walls),
        ),
        (
            "pair_viscosity_share",
            IMPLICIT,
            place(&raw.pair_viscosity_share),
        ),
        ("rotation", IMPLICIT, place(&raw.rotation)),
        ("seepage_interval", IMPLICIT, place(&raw.seepage_interval)),
        ("resize_rings", IMPLICIT, place(&raw.resize_rings)),
        ("solver_tolerance", IMPLICIT, place(&raw.solver_tolerance)),
        (
            "solver_max_iterations",
            IMPLICIT,
            place(&raw.solver_max_iterations),
        ),
        (
            "artificial_viscosity",
            ARTIFICIAL,
            place(&raw.artificial_viscosity),
        ),
        ("shifting", DIFFUSIVE, place(&raw.shifting)),
        (
            "reference_yield_stress",
            PAPER_A,
            place(&raw.reference_yield_stress),
        ),
        ("scaling_time", PAPER_A, place(&raw.scaling_time)),
        (
            "ghost_velocity_factor",
            PAPER_A,
            place(&raw.ghost_velocity_factor),
        ),
        ("sweeps", PAPER_A, place(&raw.sweeps)),
        ("relaxation_factor", PAPER_B, place(&raw.relaxation_factor)),
        ("stiffening_time", PAPER_B, place(&raw.stiffening_time)),
    ]
}

fn place<T>(at: &Option<At<T>>) -> Option<&Place> {
    at.as_ref().map(|at| &at.place)
}

fn name(word: SchemeWord) -> &'static str {
    match word {
        SchemeWord::Implicit => "\"implicit\"",
        SchemeWord::PaperA => "\"paper_a\"",
        SchemeWord::PaperB => "\"paper_b\"",
    }
}

impl Lift<'_> {
    /// The scheme with its own numbers; reports keys that it does not use.
    pub(super) fn scheme(
        &mut self,
        raw: &RawNumerics,
        table: &Place,
        materials: &[Option<NamedMaterial>],
    ) -> Option<Scheme> {
        let at = raw.scheme.as_ref()?;
        let word = at.value;
        for (key, users, place) in keys(raw) {
            let given = place.filter(|_| raw.given.contains(&key));
            if let Some(place) = given.filter(|_| !users.contains(&word)) {
                let users: Vec<&str> = users.iter().map(|w| name(*w)).collect();
                self.problems.report(
                    place,
                    format!("{key}, which this scheme does not use"),
                    format!("{key} only with scheme = {}", users.join(" or ")),
                    "delete it, or choose the other scheme",
                );
            }
        }
        if word != SchemeWord::Implicit && self.axisymmetric() {
            self.problems.report(
                &at.place,
                format!("{} in an axisymmetric scene", name(word)),
                "\"implicit\", the only scheme that knows hoop strain",
                "leave scheme out, or set dimension = 2",
            );
        }
        match word {
            SchemeWord::Implicit => Some(Scheme::Implicit),
            SchemeWord::PaperA => {
                self.check_paper_a(materials);
                self.paper_a(raw, table, materials).map(Scheme::PaperA)
            }
            SchemeWord::PaperB => {
                self.check_paper_b(materials);
                Some(Scheme::PaperB(paper_b(raw, materials)))
            }
        }
    }

    /// Gates, inflows and outflows, which the reference schemes have no equations for.
    pub(super) fn refuse_devices(&mut self, supported: &str) {
        let raw = self.raw;
        let gates = raw.gates.iter().flat_map(|s| &s.value.0);
        let inflows = raw.inflows.iter().flat_map(|s| &s.value.0);
        let outflows = raw.outflows.iter().flat_map(|s| &s.value.0);
        let devices = gates.map(|e| (&e.place, "a gate"));
        let devices = devices.chain(inflows.map(|e| (&e.place, "an inflow")));
        let devices = devices.chain(outflows.map(|e| (&e.place, "an outflow")));
        for (place, what) in devices.collect::<Vec<_>>() {
            self.problems.report(place, what, supported, REMEDY);
        }
    }
}

/// How a wall moves, which the reference schemes have no equations for.
pub(super) fn motion(wall: &RawWall) -> Option<&'static str> {
    let moves = |v: &Vec<f64>| v.iter().any(|c| *c != 0.0);
    let velocity = wall.velocity.as_ref();
    if velocity.is_some_and(|v| moves(&v.value.values)) {
        return Some("a wall that moves");
    }
    wall.angular_velocity
        .is_some()
        .then_some("a wall that turns")
}
