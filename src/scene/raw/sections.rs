//! The tables of a scene file, in the order people write them.

use super::*;

table! {
    /// A scene: everything a case file says.
    RawScene {
        /// Identifier of the scene; names its FMU and its keys on the bus.
        required name: Name;
        /// One line for people.
        optional title: Text, default "";
        /// What coordinates stand for: 2 (plane strain, x and y), 3, or "axisymmetric": x is the radius r >= 0, y the height along the axis of symmetry r = 0; masses, forces and discharges are for whole rings.
        optional dimension: DimensionWord, default 2;
        /// Extent, periodic sides, width and gravity.
        required domain: RawDomain;
        /// Resolution and every numerical choice.
        required numerics: RawNumerics;
        /// At least one; bodies and inflows refer to them by name.
        required materials: Named<RawMaterial>;
        /// What is there at the start; a scene without bodies needs an inflow.
        optional bodies: Named<RawBody>;
        /// Force gauges refer to them as wall.NAME.
        optional walls: Named<RawWall>;
        /// The opening is the input gate.NAME.opening; force gauges refer to gates as gate.NAME.
        optional gates: Named<RawGate>;
        /// The rate is the input inflow.NAME.rate.
        optional inflows: Named<RawInflow>;
        /// Outputs are outflow.NAME.mass and outflow.NAME.rate.
        optional outflows: Named<RawOutflow>;
        /// Outputs are gauge.NAME.*, each with a validity flag.
        optional gauges: Named<RawGauge>;
        /// Communication step and end time.
        required run: RawRun;
        /// For runs without an orchestrator; one for each input at most.
        optional schedule: List<RawSchedule>;
        /// What a run writes to its log.
        optional log: RawLog;
    }
}

table! {
    /// Extent and gravity.
    RawDomain {
        /// Lower corner; a particle that leaves the domain other than by an outflow or a periodic side is an error.
        required lower: Coordinates<Length>;
        /// Upper corner.
        required upper: Coordinates<Length>;
        /// Axes along which the domain repeats itself.
        optional periodic: List<Axis>;
        /// Out-of-plane width of a planar scene: masses, forces and discharges are for this width. Not where dimension is 3 or "axisymmetric".
        optional width: Length, in Range::above(0.0), default "1 m";
        /// Gravitational acceleration: its size, downwards along the last axis, or a vector.
        optional gravity: Gravity, default "9.81 m/s^2";
        /// Slope of the bed: turns gravity towards +x, so that a bed along x is an inclined plane. Not with a gravity vector, nor in axisymmetric scenes.
        optional slope: Angle, in Range::within(-1.5, 1.5);
    }
}

choice! {
    /// An axis.
    Axis {
        /// First axis.
        "x" => X,
        /// Second axis.
        "y" => Y,
        /// Third axis, in space.
        "z" => Z,
    }
}

table! {
    /// Resolution and every numerical choice.
    RawNumerics {
        /// Particle spacing dp: the resolution. Bodies are filled on a lattice of this spacing, the first row half a spacing inside.
        required spacing: Length, in Range::above(0.0);
        /// Resolution, as the studies in docs/precision.md found it worth its time: spacing is that of "standard".
        optional quality: QualityWord, default "standard";
        /// Smoothing length over particle spacing.
        optional smoothing_ratio: Ratio, in Range::within(1.2, 2.5), default 1.6;
        /// Artificial sound speed c0; if left out, 10 max(sqrt(g H), expected_speed), H the greatest height of material.
        optional sound_speed: Speed, in Range::above(0.0);
        /// Largest speed that the flow is expected to reach; raises the sound speed. Give it when material moves faster than sqrt(g H).
        optional expected_speed: Speed, in Range::from(0.0), default 0;
        /// Compressibility K_t of the grains, instead of sound_speed: c0 = 1/sqrt(K_t rho_s phi_max), rho_s the grains' density.
        optional grain_compressibility: Compressibility, in Range::above(0.0);
        /// How forces are formed and integrated in time.
        optional scheme: SchemeWord, default "implicit";
        /// Acoustic Courant number: acoustic step over h/c0; if left out, 0.7, or 0.5 with the schemes paper_a and paper_b.
        optional courant: Ratio, in Range::above_to(0.0, 1.0);
        /// Acoustic steps to an internal step, where neighbours and walls are slower than 0.03 c0 against each other: pressure and density take so many to one solve of friction (docs/decisions/014-two-acoustic-steps.md). If left out, 2 in planar scenes and in space where all is dry grains without bulk friction, artificial viscosity and a density_diffusion above 0.5; others take 1.
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
        /// Density diffusion; 0 switches it off.
        optional density_diffusion: Ratio, in Range::within(0.0, 1.0), default 0.1;
        /// Time scale that switches density diffusion off where material rests.
        optional diffusion_gate_time: Time, in Range::from(0.0), default "0.3 s";
        /// Relaxation time of the strain rate in the pressure law; 20 to 200 ms is useful.
        optional strain_relaxation_time: Time, in Range::above(0.0), default "50 ms";
        /// Share of viscous stress carried pair by pair, against zero-energy modes; left out: 0.05, or 0.5 in scenes of Newtonian fluids alone.
        optional pair_viscosity_share: Ratio, in Range::within(0.0, 0.95);
        /// Artificial viscosity alpha.
        optional artificial_viscosity: Ratio, in Range::within(0.0, 10.0), default 0;
        /// Factor on the shifting of particles towards even spacing; 0 switches it off, 1 is the published strength. Left out: 0, with scheme paper_b 1. With scheme implicit particles of materials with friction are never shifted.
        optional shifting: Ratio, in Range::within(0.0, 1.0);
        /// Relative tolerance of the viscous solve.
        optional solver_tolerance: Ratio, in Range::within(1e-14, 0.1), default 3e-4;
        /// Most iterations of a viscous solve.
        optional solver_max_iterations: Whole, in Range::within(1.0, 1e6), default 5000;
        /// Whether a scene in which nothing moves is not computed until an input changes. Heights and fronts differ by less than 1e-4 of the height of the material, forces on walls by less than 1 %. Scenes without walls, with walls that move, or with a material that may creep on (a power law, or a viscosity above 1e-4 rho sqrt(g H^3)) never sleep.
        optional sleep: Flag, default true;
        /// Internal steps from one solve of the pore pressure of saturated beds to the next; 1 solves it in every step. 4 changes depths as another seed does (0.3 to 1.2 % rms over 2 s of the reduced silted dam), 16 by 5 %.
        optional seepage_interval: Whole, in Range::within(1.0, 1000.0), default 4;
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
    /// What holds material under its yield stress.
    YieldWord {
        /// nothing moves under the yield stress
        "exact" => Exact,
        /// a very viscous fluid, which creeps at up to 1/cap_time
        "capped" => Capped,
    }
}

table! {
    /// Material that is there at the start. Exactly one of box, polygon, circle and column says where.
    RawBody {
        /// Name of its material.
        required material: Text;
        /// An axis-aligned box.
        optional r#box: RawBox;
        /// Planar: corners of a simple polygon, in order.
        optional polygon: List<Coordinates<Length>>;
        /// Planar: a disc.
        optional circle: RawCircle;
        /// Space: an upright round column.
        optional column: RawColumn;
        /// Fills the shape only below this height: a reservoir filled to a level.
        optional level: Length;
        /// Velocity at the start.
        optional velocity: Coordinates<Speed>;
        /// A layer on a slope that starts in steady flow; only for a box whose lower side lies on the bed.
        optional velocity_profile: ProfileWord;
    }
}

choice! {
    /// Velocity over the height of a layer.
    ProfileWord {
        /// Bagnold's profile of steady flow, added to velocity, with its density and shear rate
        "bagnold" => Bagnold,
    }
}

table! {
    /// An axis-aligned box.
    RawBox {
        /// Lower corner.
        required lower: Coordinates<Length>;
        /// Upper corner.
        required upper: Coordinates<Length>;
    }
}

table! {
    /// An upright round column.
    RawColumn {
        /// Centre of its base.
        required base: Coordinates<Length>;
        /// Radius of the column.
        required radius: Length, in Range::above(0.0);
        /// Height along z.
        required height: Length, in Range::above(0.0);
        /// Only the quarter where x and y are beyond the base's centre, to stand in the corner of two free-slip planes.
        optional quarter: Flag, default false;
    }
}

choice! {
    /// What a wall does to material that slides along it.
    SlipWord {
        /// material sticks to the wall
        "no_slip" => NoSlip,
        /// no shear stress at the wall
        "free_slip" => FreeSlip,
        /// Coulomb friction: material sticks until the shear stress is wall_friction times the normal one, then slides
        "friction" => Friction,
    }
}

table! {
    /// A wall. Exactly one of polyline, circle, box and plane says where.
    RawWall {
        /// Planar: a chain of points with the material on its left; the wall lies on its right, four particle rows deep.
        optional polyline: List<Coordinates<Length>>;
        /// Whether the polyline's last point joins the first.
        optional closed: Flag;
        /// Planar: a round wall with the material inside, a drum.
        optional circle: RawCircle;
        /// A solid box, an obstacle.
        optional r#box: RawBox;
        /// A plane, with material on the side of its normal.
        optional plane: RawPlane;
        /// Whether material sticks or slides.
        optional slip: SlipWord, default "no_slip";
        /// Coefficient mu_w of slip = "friction", tan of the wall friction angle.
        optional wall_friction: Ratio, in Range::from(0.0);
        /// What velocity and angular_velocity move.
        optional motion: MotionWord, default "belt";
        /// Velocity. Of a belt: along its surface, in axisymmetric scenes not along r where the wall reaches the axis. Of a rigid wall: any, of a plane along its normal.
        optional velocity: Coordinates<Speed>;
        /// Rate of turning about `centre`: anticlockwise in the plane, in space right-handed about `axis`. Rigid polylines, circles and boxes, and belts that are planes across `axis`; planes cannot turn otherwise.
        optional angular_velocity: AngularSpeed;
        /// Centre of rotation; it moves with `velocity`.
        optional centre: Coordinates<Length>;
        /// In space: axis of rotation, of any length.
        optional axis: Coordinates<Ratio>;
    }
}

choice! {
    /// What moves of a wall that has a velocity.
    MotionWord {
        /// its surface slides along itself and the wall stays where it is: a conveyor belt
        "belt" => Belt,
        /// the wall moves as a whole: a piston, a falling floor, a drum
        "rigid" => Rigid,
    }
}

table! {
    /// A circle.
    RawCircle {
        /// Its centre.
        required centre: Coordinates<Length>;
        /// Its radius.
        required radius: Length, in Range::above(0.0);
    }
}

table! {
    /// A plane.
    RawPlane {
        /// A point of the plane.
        required point: Coordinates<Length>;
        /// Normal towards the material, of any length.
        required normal: Coordinates<Ratio>;
    }
}

table! {
    /// A plate that slides along its own length. Its face runs from `from` to `to` with material on the left (in space on the side of span x (to - from), where an inflow's is the other); opening o uncovers the share o next to `from`, and the plate retracts beyond `to`.
    RawGate {
        /// End that opens first.
        required from: Coordinates<Length>;
        /// End towards which the plate retracts.
        required to: Coordinates<Length>;
        /// In space: the vector along which the face is extruded.
        optional span: Coordinates<Length>;
        /// Depth of the plate behind its face, at least 4 spacings; 4 spacings if left out.
        optional thickness: Length, in Range::above(0.0);
        /// Largest speed of the plate. Above c0/7 (with courant 0.7) it may be held to that: it moves 0.1 h a step at most.
        optional max_speed: Speed, in Range::above(0.0), default "0.5 m/s";
        /// Opening at the start: 0 closed, 1 open.
        optional start: Ratio, in Range::within(0.0, 1.0), default 0;
        /// Whether material sticks to its faces.
        optional slip: SlipWord, default "free_slip";
        /// Coefficient mu_w of slip = "friction", tan of the wall friction angle.
        optional wall_friction: Ratio, in Range::from(0.0);
    }
}

table! {
    /// A source: rows of particles enter through the face from `from` to `to`, on its left side, at a set velocity. Rows come in only where a spacing before the face is free: it must be above the surface or in free room, since a source under material is blocked.
    RawInflow {
        /// Name of the material that enters.
        required material: Text;
        /// One end of the face; in space one corner.
        required from: Coordinates<Length>;
        /// Other end of the face; in space the corner next to it.
        required to: Coordinates<Length>;
        /// In space: the face's second edge, from `from`.
        optional span: Coordinates<Length>;
        /// Velocity of entering material; it points to the left of the way from `from` to `to` (in space: along (to - from) x span).
        required velocity: Coordinates<Speed>;
        /// Rate at the start.
        optional rate: MassRate, in Range::from(0.0), default 0;
    }
}

table! {
    /// A box in which particles are taken out and counted.
    RawOutflow {
        /// Lower corner.
        required lower: Coordinates<Length>;
        /// Upper corner.
        required upper: Coordinates<Length>;
    }
}

tagged! {
    /// Something measured at every communication step.
    RawGauge by kind {
        "depth" => Depth(RawDepth),
        "profile" => Profile(RawProfile),
        "discharge" => Discharge(RawDischarge),
        "force" => Force(RawForce),
        "pressure" => Pressure(RawPressure),
        "interface_stress" => InterfaceStress(RawInterfaceStress),
        "front" => Front(RawFront),
        "mass" => Mass(RawMass),
    }
}

table! {
    /// Depth along a line: from the foot to the highest point of material on it.
    RawDepth {
        /// Foot of the line, on the bed.
        required foot: Coordinates<Length>;
        /// Direction of the line, of any length; upwards along the last axis if left out.
        optional up: Coordinates<Ratio>;
        /// Length of the line; up to the domain's edge if left out.
        optional length: Length, in Range::above(0.0);
        /// Only this material; all if left out.
        optional material: Text;
    }
}

table! {
    /// Shear stress where a material ends and another begins: what water drags on a bed with.
    RawInterfaceStress {
        /// Foot of the line, on the bed.
        required foot: Coordinates<Length>;
        /// Direction of the line, of any length; upwards along the last axis if left out.
        optional up: Coordinates<Ratio>;
        /// Length of the line; up to the domain's edge if left out.
        optional length: Length, in Range::above(0.0);
        /// The material whose highest point on the line is looked at.
        required material: Text;
    }
}

table! {
    /// Depths at evenly spaced feet: a surface profile.
    RawProfile {
        /// First foot.
        required from: Coordinates<Length>;
        /// Last foot.
        required to: Coordinates<Length>;
        /// Number of feet.
        required count: Whole, in Range::within(2.0, 10_000.0);
        /// Direction of the lines, of any length; upwards along the last axis if left out.
        optional up: Coordinates<Ratio>;
        /// Length of the lines; up to the domain's edge if left out.
        optional length: Length, in Range::above(0.0);
        /// Only this material; all if left out.
        optional material: Text;
    }
}

table! {
    /// Mass that crosses a section from the left of the way `from` - `to` to its right, per time.
    RawDischarge {
        /// One end of the section; in space one corner.
        required from: Coordinates<Length>;
        /// Other end; in space the corner next to it.
        required to: Coordinates<Length>;
        /// In space: the section's second edge, from `from`.
        optional span: Coordinates<Length>;
        /// Only this material; all if left out.
        optional material: Text;
    }
}

table! {
    /// Force of the material on a wall or gate, mean over the communication step.
    RawForce {
        /// The wall or gate: wall.NAME or gate.NAME.
        required on: Text;
    }
}

table! {
    /// Pressure at a point.
    RawPressure {
        /// The point.
        required at: Coordinates<Length>;
        /// Which pressure: of the whole material, in the pores, or of grain on grain.
        optional quantity: QuantityWord, default "total";
        /// Only this material; all if left out.
        optional material: Text;
    }
}

choice! {
    /// Which pressure a gauge reads.
    QuantityWord {
        /// that of the material with all that is in its pores
        "total" => Total,
        /// that of fluids, and of the fluid in the pores of saturated materials
        "pore" => Pore,
        /// that of grain on grain, what the pores do not carry: materials with friction only
        "effective" => Effective,
    }
}

table! {
    /// Outermost position of material along a direction.
    RawFront {
        /// Depth that counts as material, at least one spacing; one spacing if left out.
        optional least_depth: Length, in Range::above(0.0);
        /// Where distances start, on the bed.
        required origin: Coordinates<Length>;
        /// Direction along the bed, of any length.
        required direction: Coordinates<Ratio>;
        /// Direction of depth, of any length; upwards along the last axis if left out.
        optional up: Coordinates<Ratio>;
        /// Only this material; all if left out.
        optional material: Text;
    }
}

table! {
    /// Mass of material in a box: what of a bed is still there.
    RawMass {
        /// Lower corner of the box.
        required lower: Coordinates<Length>;
        /// Upper corner of the box.
        required upper: Coordinates<Length>;
        /// Only this material; all if left out.
        optional material: Text;
    }
}

table! {
    /// Times of a run.
    RawRun {
        /// Communication step: inputs are read and gauges sampled this often.
        required step: Time, in Range::above(0.0);
        /// End of a run without an orchestrator, and default stop time of the FMU.
        required until: Time, in Range::above(0.0);
    }
}

table! {
    /// What an input is told over time when nobody else sets it.
    RawSchedule {
        /// The input: gate.NAME.opening or inflow.NAME.rate.
        required input: Text;
        /// Points [time, value] in ascending time; the first value holds before, the last after them.
        required points: List<SeriesPoint>;
        /// Between points: a straight line, or hold the earlier value.
        optional interpolation: InterpolationWord, default "linear";
    }
}

choice! {
    /// How a schedule goes from point to point.
    InterpolationWord {
        /// straight lines between points
        "linear" => Linear,
        /// hold the earlier value
        "hold" => Hold,
    }
}

table! {
    /// What a run writes to its log.
    RawLog {
        /// Particle snapshots every so many seconds of simulated time; 0 writes none.
        optional particles_every: Time, in Range::from(0.0), default "50 ms";
        /// Whether a run stops when its log cannot be written.
        optional required: Flag, default true;
        /// Whether equal runs give equal bytes: no wall clock in the log, and chunks end with communication steps.
        optional deterministic: Flag, default false;
        /// Begin a new file every so many seconds of simulated time; 0 never does.
        optional rotate_every: Time, in Range::from(0.0), default 0.0;
        /// Begin a new file when the messages of one take so many megabytes; 0 never does.
        optional rotate_megabytes: Ratio, in Range::from(0.0), default 0.0;
        /// When the system is asked to bring what was written to the disk.
        optional sync: SyncWord, default "file";
    }
}

choice! {
    /// When written bytes are brought to the disk, so that they survive a loss of power.
    SyncWord {
        /// when a file is finished; a loss of power may cost what the system had not written by itself
        "file" => File,
        /// twice a second (in deterministic logs after every communication step); slower
        "flush" => Flush,
    }
}
