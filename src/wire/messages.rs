//! The project's own messages, package `sandgate`. Times are simulated time; `timestamp` is `time` rounded to
//! nanoseconds for viewers, the exact value is the f64.
//!
//! Rules of change: a field's number and type never change, a removed number is never used again.

messages! {
    /// One output of the component at a communication point.
    "sandgate.Gauge": pub struct Gauge {
        /// Simulated time, rounded to nanoseconds.
        #[prost(message, optional, tag = "1")]
        pub timestamp: Option<prost_types::Timestamp>,
        /// Simulated time [s].
        #[prost(double, tag = "2")]
        pub time: f64,
        /// Communication steps done when it was read.
        #[prost(uint64, tag = "3")]
        pub step: u64,
        /// Counts the messages of this output from 0: a gap means that messages were lost.
        #[prost(uint64, tag = "4")]
        pub sequence: u64,
        /// Name in the table of variables: `gauge.weir.depth`.
        #[prost(string, tag = "5")]
        pub name: String,
        /// SI unit, empty if it has none.
        #[prost(string, tag = "6")]
        pub unit: String,
        /// The value, or all values of an array in the table's order.
        #[prost(double, repeated, tag = "7")]
        pub values: Vec<f64>,
        /// Whether the gauge could measure; outputs without such a flag are always valid.
        #[prost(enumeration(Validity), tag = "8")]
        pub validity: i32,
    } with {
        /// What a gauge's flag says; the numbers are those of the `.validity` variables.
        "sandgate.Gauge.Validity": pub enum Validity {
            /// The value is a measurement.
            Valid = 0,
            /// No material where it measures.
            Empty = 1,
            /// The place is outside the domain.
            Outside = 2,
            /// A wall or gate stands in the way.
            Blocked = 3,
        }
    }

    /// What drove the component, in the order in which it took effect: all that a later run needs to repeat this one
    /// bit for bit.
    "sandgate.Applied": pub struct Applied {
        /// Simulated time at which it took effect, rounded to nanoseconds.
        #[prost(message, optional, tag = "1")]
        pub timestamp: Option<prost_types::Timestamp>,
        /// Which call it was.
        #[prost(enumeration(AppliedEvent), tag = "2")]
        pub event: i32,
        /// Number of the communication step that used these inputs, from 1; 0 for INITIALIZE.
        #[prost(uint64, tag = "3")]
        pub step: u64,
        /// Bits of the f64 `t`: start of the step, or start time of INITIALIZE.
        #[prost(fixed64, tag = "4")]
        pub t_bits: u64,
        /// Bits of the f64 `h`: length of the step; of INITIALIZE the stop time, NaN if it has none.
        #[prost(fixed64, tag = "5")]
        pub h_bits: u64,
        /// `t` as a number, for plots [s].
        #[prost(double, tag = "6")]
        pub t: f64,
        /// `h` as a number, for plots [s].
        #[prost(double, tag = "7")]
        pub h: f64,
        /// Inputs set since the call before, in the order in which they were set; of more than 1,024 only the last of each.
        #[prost(message, repeated, tag = "8")]
        pub inputs: Vec<AppliedInput>,
        /// Who made the call: "run", "fmi3", "c", or the name of a Zenoh client.
        #[prost(string, tag = "9")]
        pub source: String,
        /// What was done to inputs inside the step, in the order of time.
        #[prost(message, repeated, tag = "10")]
        pub moments: Vec<AppliedMoment>,
        /// SAVE, and RESTORE of a state that was saved in the same file: which state, by its checksum (SHA-256).
        #[prost(bytes = "vec", tag = "11")]
        pub state: Vec<u8>,
    } with {
        /// Calls that drive a component.
        "sandgate.Applied.Event": pub enum AppliedEvent {
            /// `do_step(t, h)`.
            Step = 0,
            /// `initialize(t, stop)`.
            Initialize = 1,
            /// `reset()`: back to start values.
            Reset = 2,
            /// `restore(...)`: back or forth to a saved state: that of SAVE with the same checksum, or the one that the
            /// file starts from.
            Restore = 3,
            /// Inputs that were set after the last step of the file: no step of it used them.
            Set = 4,
            /// `save()`: a state that the component may be brought back to.
            Save = 5,
        }
    }

    /// One variable that was set.
    "sandgate.AppliedInput": pub struct AppliedInput {
        /// Handle in the table of variables.
        #[prost(uint32, tag = "1")]
        pub reference: u32,
        /// Name in the table of variables.
        #[prost(string, tag = "2")]
        pub name: String,
        /// Bits of the f64 values, flat.
        #[prost(fixed64, repeated, tag = "3")]
        pub bits: Vec<u64>,
        /// The same values as numbers, for plots; in the variable's unit.
        #[prost(double, repeated, tag = "4")]
        pub values: Vec<f64>,
        /// Who set it.
        #[prost(string, tag = "5")]
        pub source: String,
        /// Whether the values are slopes that the inputs have over the step, per second, and not their values.
        #[prost(bool, tag = "6")]
        pub slope: bool,
    }

    /// What was done inside a step, after one of its internal steps.
    "sandgate.AppliedMoment": pub struct AppliedMoment {
        /// Bits of the f64 time at which the internal step ended.
        #[prost(fixed64, tag = "1")]
        pub t_bits: u64,
        /// Inputs set for the rest of the step.
        #[prost(message, repeated, tag = "2")]
        pub inputs: Vec<AppliedInput>,
        /// Whether the step was to end early.
        #[prost(bool, tag = "3")]
        pub ends: bool,
        /// Bits of the f64 time at which it was to end, if so; at once if that had passed.
        #[prost(fixed64, tag = "4")]
        pub end_bits: u64,
    }

    /// A call of the component from outside, or the reply to one: Zenoh RPC, FMI, C or the program.
    "sandgate.Command": pub struct Command {
        /// Simulated time when it came, rounded to nanoseconds.
        #[prost(message, optional, tag = "1")]
        pub timestamp: Option<prost_types::Timestamp>,
        /// Simulated time [s].
        #[prost(double, tag = "2")]
        pub time: f64,
        /// Request or reply.
        #[prost(enumeration(CommandKind), tag = "3")]
        pub kind: i32,
        /// Who was asked: "rpc", "fmi2", "fmi3", "c" or "cli"; "in" for set-points.
        #[prost(string, tag = "4")]
        pub interface: String,
        /// What is asked: `step`, `fmi3DoStep`, `sandgate_step`; a set-point's variable.
        #[prost(string, tag = "5")]
        pub verb: String,
        /// The caller's identifier of the request, the same in the reply.
        #[prost(string, tag = "6")]
        pub request: String,
        /// Who asks, if it said so.
        #[prost(string, tag = "7")]
        pub client: String,
        /// Request or reply as JSON text, as it came or went.
        #[prost(string, tag = "8")]
        pub body: String,
        /// Replies and set-points: "ok" or the error's code; of a set-point that a newer one of its variable replaced before
        /// it could be taken "superseded"; empty in requests.
        #[prost(string, tag = "9")]
        pub status: String,
    } with {
        /// Which way a command goes.
        "sandgate.Command.Kind": pub enum CommandKind {
            /// To the component.
            Request = 0,
            /// From the component.
            Reply = 1,
        }
    }

    /// Figures of the solver after a communication step, with the account of mass.
    "sandgate.StepStats": pub struct StepStats {
        /// Simulated time, rounded to nanoseconds.
        #[prost(message, optional, tag = "1")]
        pub timestamp: Option<prost_types::Timestamp>,
        /// Simulated time reached [s].
        #[prost(double, tag = "2")]
        pub time: f64,
        /// Communication steps done.
        #[prost(uint64, tag = "3")]
        pub step: u64,
        /// Counts these messages from 0.
        #[prost(uint64, tag = "4")]
        pub sequence: u64,
        /// Internal steps of this communication step, none while the scene sleeps; 4294967295 for more.
        #[prost(uint32, tag = "5")]
        pub substeps: u32,
        /// Smallest of them; of a scene that sleeps throughout, the time slept [s].
        #[prost(double, tag = "6")]
        pub smallest_step: f64,
        /// What bound it: "acoustic", "motion", "viscous", "communication", or "asleep" where nothing was computed; empty before the first step.
        #[prost(string, tag = "7")]
        pub bound_by: String,
        /// Iterations of the viscous solve, summed over the internal steps; 4294967295 for more.
        #[prost(uint32, tag = "8")]
        pub iterations: u32,
        /// Particles present.
        #[prost(uint64, tag = "9")]
        pub particles: u64,
        /// Last internal step [s].
        #[prost(double, tag = "10")]
        pub step_size: f64,
        /// Kinetic energy [J].
        #[prost(double, tag = "11")]
        pub kinetic_energy: f64,
        /// Largest speed of a particle [m/s].
        #[prost(double, tag = "12")]
        pub max_speed: f64,
        /// Share of the mass with inertial number above 0.3 [1].
        #[prost(double, tag = "13")]
        pub share_dilute: f64,
        /// Internal steps since the start.
        #[prost(uint64, tag = "14")]
        pub total_substeps: u64,
        /// Iterations since the start.
        #[prost(uint64, tag = "15")]
        pub total_iterations: u64,
        /// Account of mass: exact in f64.
        #[prost(message, optional, tag = "16")]
        pub ledger: Option<MassLedger>,
        /// Share of the particles that sleep [1]: where nothing moves nothing is computed.
        #[prost(double, tag = "17")]
        pub share_asleep: f64,
    }

    /// Account of mass: initial + inflow - outflow = present, exactly.
    "sandgate.MassLedger": pub struct MassLedger {
        /// Mass at the start [kg].
        #[prost(double, tag = "1")]
        pub initial: f64,
        /// Mass that came in since [kg].
        #[prost(double, tag = "2")]
        pub inflow: f64,
        /// Mass that left since [kg].
        #[prost(double, tag = "3")]
        pub outflow: f64,
        /// Mass present, summed over particles [kg].
        #[prost(double, tag = "4")]
        pub present: f64,
    }
}
