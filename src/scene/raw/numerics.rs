//! Tables of numerical choices.

use super::*;

table! {
    /// Resolution and every numerical choice.
    RawNumerics {
        /// Particle spacing dp: the resolution. Bodies are filled on a lattice of this spacing, the first row half a spacing inside.
        required spacing: Length, in Range::above(0.0);
        /// Resolution, as the studies in docs/precision.md found it worth its time: spacing is that of "standard". Where a gate's thickness, a circle or a period as given would not fit the other spacing, the nearest that fits is taken.
        optional quality: QualityWord, default "standard";
        /// Smoothing length over particle spacing.
        optional smoothing_ratio: Ratio, in Range::within(1.2, 2.5), default 1.6;
        /// Artificial sound speed c0; not below sqrt(g H), H the greatest height of material, or expected_speed; if left out, 10 times the larger of both. Given, it is taken as it is, and expected_speed only checks it. For pressures beyond rho g H, as under a piston or of a viscous fluid in a gap, give more: up to 0.005 rho c0^2 they are right to about a percent.
        optional sound_speed: Speed, in Range::above(0.0);
        /// Largest speed that the flow is expected to reach; raises the sound speed, unless sound_speed or grain_compressibility gives that. Give it when material moves faster than sqrt(g H).
        optional expected_speed: Speed, in Range::from(0.0), default 0;
        /// Compressibility K_t of the grains, instead of sound_speed: c0 = 1/sqrt(K_t rho_s phi_max), rho_s the grains' density.
        optional grain_compressibility: Compressibility, in Range::above(0.0);
        /// How forces are formed and integrated in time.
        optional scheme: SchemeWord, default "implicit";
        /// Acoustic Courant number: acoustic step over h/c0; if left out, 0.7, or 0.5 with the schemes paper_a and paper_b.
        optional courant: Ratio, in Range::above_to(0.0, 1.0);
        /// Acoustic steps to an internal step, where neighbours and walls are slower than 0.03 c0 against each other: pressure and density take so many to one solve of friction (docs/decisions/014-two-acoustic-steps.md). If left out, 2 in planar scenes and in space where all is dry grains without consistency, bulk friction, artificial viscosity and a density_diffusion above 0.5; others take 1.
        optional acoustic_steps: Whole, in Range::within(1.0, 2.0);
        /// Scheme paper_a: the largest yield stress that is expected, tau_0; if left out, tan(static_friction_angle) times the weight of the deepest material.
        optional reference_yield_stress: Pressure, in Range::above(0.0);
        /// Scheme paper_a: scaling time m_0 of the regularised viscosity at that stress. Longer creeps less and takes smaller steps.
        optional scaling_time: Time, in Range::above(0.0), default "1 s";
        /// Scheme paper_a: largest factor beta_max of a grain's velocity against the ghosts behind a wall.
        optional ghost_velocity_factor: Ratio, in Range::within(1.0, 10.0), default 1.5;
        /// Scheme paper_a: how sums over pairs run. Results differ by rounding.
        optional sweeps: SweepsWord, default "lanes";
        /// Scheme paper_b: factor K_R on the acceleration of what does not yield; if left out, 1 for one fluid that yields below 100 Pa, 0.05 for other single materials, 0.01 for several.
        optional relaxation_factor: Ratio, in Range::above_to(0.0, 1.0);
        /// Scheme paper_b: stiffening time m of Papanastasiou's viscosity; if left out, 0.1 s for fluids that yield below 100 Pa, else 0.01 s. Longer takes smaller steps.
        optional stiffening_time: Time, in Range::above(0.0);
        /// How the yield stress holds material at rest.
        optional r#yield: YieldWord, default "exact";
        /// Iterations of the exact yield in each internal step; they start from the last step's, so 1 is usual.
        optional yield_iterations: Whole, in Range::within(1.0, 100.0), default 1;
        /// Cap of the viscosity: at most cap_time x (cohesion + mu_s x pressure). With a capped yield a plug creeps at up to 1/cap_time, and 20 c0/g is taken if this is left out; with the exact yield it sets how fast the iteration goes, and 2 c0/g is taken.
        optional cap_time: Time, in Range::above(0.0);
        /// Density diffusion; 0 switches it off. It does no more in a step than even a particle out with its neighbours: from 0.276 (in space 0.237) over acoustic_steps on, at the courant number and smoothing ratio left out, more changes nothing.
        optional density_diffusion: Ratio, in Range::within(0.0, 1.0), default 0.1;
        /// Time scale that switches density diffusion off where material rests: it has all of its strength where the shear rate is above one over this. Left out: 0.3 c0/g, which is 0.3 s where material is 0.1 m high, so that scenes of all sizes are alike.
        optional diffusion_gate_time: Time, in Range::from(0.0);
        /// Relaxation time of the strain rate in the pressure law; 20 to 200 ms is useful.
        optional strain_relaxation_time: Time, in Range::above(0.0), default "50 ms";
        /// Whether dry grains' friction goes on into walls without slip where its ratio to the pressure falls off from them, as in closed chutes, which are else several times too fast unless many rows shear (theory, W14). Columns then run out 1 to 2 % less at coarse spacings, and steps take 5 to 8 % longer. Only with `yield = "exact"`, and in scenes without fluids and saturated material; else it changes nothing.
        optional friction_into_walls: Flag, default false;
        /// Share of viscous stress carried pair by pair, against zero-energy modes; left out: 0.05, or 0.5 in scenes of Newtonian fluids alone. Above 0.5 iterations of the exact yield may run away.
        optional pair_viscosity_share: Ratio, in Range::within(0.0, 0.95);
        /// Whose rigid rotation makes no stress at free surfaces.
        optional rotation: RotationWord, default "cohesive";
        /// Artificial viscosity alpha; no step is shortened for it.
        optional artificial_viscosity: Ratio, in Range::within(0.0, 1.0), default 0;
        /// Factor on the shifting of particles towards even spacing; 0 switches it off, 1 is the published strength. Left out: 0, with scheme paper_b 1. With scheme implicit particles of materials with friction are never shifted.
        optional shifting: Ratio, in Range::within(0.0, 1.0);
        /// Relative tolerance of the viscous solve.
        optional solver_tolerance: Ratio, in Range::within(1e-14, 0.1), default 3e-4;
        /// Most iterations of a viscous solve.
        optional solver_max_iterations: Whole, in Range::within(1.0, 1e6), default 5000;
        /// Whether a scene in which nothing moves is not computed until an input changes. Heights and fronts differ by less than 1e-4 of the height of the material, forces on walls by less than 1 %. Scenes without walls, with walls that move unsteered, or with a material that may creep on (a power law, a viscosity above 1e-4 rho sqrt(g H^3), Barker and Gray's law) never sleep.
        optional sleep: Flag, default true;
        /// Scheme implicit: internal steps from one solve of the pore pressure of saturated beds to the next; 1 solves it in every step. 4 changes depths as another seed does (0.3 to 1.2 % rms over 2 s of the reduced silted dam), 16 by 5 %.
        optional seepage_interval: Whole, in Range::within(1.0, 1000.0), default 4;
        /// Axisymmetric scenes of scheme implicit: whether a ring that has grown to more than 1.5 dp^2 of section on its way to the axis is halved, and two that have shrunk below 0.25 dp^2 each on their way out are joined.
        optional resize_rings: Flag, default true;
        /// Random displacement of the starting lattice, over the spacing. Every other row is then half a spacing aside, and places are evened out. 0, scenes of rings and the schemes of the papers: a square lattice. Fluids in scenes of rings are not displaced.
        optional jitter: Ratio, in Range::within(0.0, 0.4), default 0.1;
        /// Seed of that displacement.
        optional seed: Whole, default 1;
    }
}

choice! {
    /// How accurate, how fast.
    QualityWord {
        /// for a first look: twice the spacing; about an eighth of the CPU time in the plane
        "draft" => Draft,
        /// the spacing given, defaults
        "standard" => Standard,
        /// for numbers that count: two thirds of the spacing; about three to four times the CPU time in the plane
        "fine" => Fine,
    }
}

choice! {
    /// Discretisation and time integration.
    SchemeWord {
        /// the default: implicit viscosity, steps bounded by sound only
        "implicit" => Implicit,
        /// the scheme of Minatti and Paris (2015) as they wrote it, for comparison: explicit, steps bounded by viscosity, straight fixed walls without slip only
        "paper_a" => PaperA,
        /// the scheme of Monge-Gapper et al. (2024) as they wrote it, corrected, for comparison: explicit, several phases, boundary integrals at fixed walls, unyielded material attenuated; they take smoothing_ratio = 2
        "paper_b" => PaperB,
    }
}

choice! {
    /// How sums over pairs run.
    SweepsWord {
        /// four neighbours at a time
        "lanes" => Lanes,
        /// one pair after the other, the plain form that the other is tested and timed against
        "plain" => Plain,
    }
}

choice! {
    /// Whose rigid rotation makes no stress at free surfaces; else these resist it, and a block that flies or lies on a turntable loses its spin.
    RotationWord {
        /// that of grains with cohesion and of fluids with a yield stress
        "cohesive" => Cohesive,
        /// that of all materials: where sand's surface flows its friction is then too large
        "all" => All,
        /// nobody's
        "off" => Off,
    }
}

choice! {
    /// What holds material under its yield stress.
    YieldWord {
        /// nothing moves under the yield stress
        "exact" => Exact,
        /// a very viscous fluid, which creeps at up to 1/cap_time
        "capped" => Capped,
    }
}
