//! Tables of a run: its times, what its inputs are told, and its log.

use super::*;

table! {
    /// Times of a run.
    RawRun {
        /// Communication step: inputs are read and gauges sampled this often.
        required step: Time, in Range::above(0.0);
        /// End of a run without an orchestrator, and default stop time of the FMU; at least one step, at most 1e8 of them and 1e9 internal ones.
        required until: Time, in Range::above(0.0);
    }
}

table! {
    /// What an input is told over time when nobody else sets it.
    RawSchedule {
        /// The input: gate.NAME.opening, inflow.NAME.rate, or of a steered wall wall.NAME.speed, wall.NAME.position or wall.NAME.angle.
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
        /// Particle snapshots every so many seconds of simulated time, no shorter than run.step; 0 writes none.
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
