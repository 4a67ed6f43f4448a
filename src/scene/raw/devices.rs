//! Tables of walls, gates, inflows and outflows.

use super::*;

choice! {
    /// What a wall does to material that slides along it.
    SlipWord {
        /// material sticks to the wall
        "no_slip" => NoSlip,
        /// no shear stress at the wall
        "free_slip" => FreeSlip,
        /// Coulomb friction: grains stick until the shear stress is wall_friction times the normal one, then slide; fluids, clay too, slide freely
        "friction" => Friction,
    }
}

table! {
    /// A wall. Exactly one of polyline, circle, box and plane says where.
    RawWall {
        /// Planar: a chain of 2 to 1,000 points with the material on its left; the wall lies on its right, four particle rows deep.
        optional polyline: List<Coordinates<Length>>;
        /// Whether the polyline's last point joins the first.
        optional closed: Flag;
        /// Planar: a round wall with the material inside, a drum, of 4 to 300 spacings in radius.
        optional circle: RawCircle;
        /// A solid box, an obstacle. Thinner than 4 spacings it is too little wall: force gauges on it read up to two fifths too little.
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
        /// Makes its motion an input, and velocity (or angular_velocity) the fastest it goes: positive inputs go their way. Of a wall with both, it is the way along velocity, and it turns in proportion.
        optional input: DriveWord;
        /// With input = "speed": speed at the start, over that of velocity or angular_velocity; 0 if left out: it stands until it is told to move.
        optional start: Ratio, in Range::within(-1.0, 1.0);
        /// With input = "speed": time in which it comes from a standstill to its full speed, or back; 0 s if left out: at once.
        optional ramp: Time, in Range::from(0.0);
        /// With input, of a rigid wall with velocity: how far it goes along it, from where it is drawn, which is one end stop, to the other; left out with input = "speed": as far as its speed takes it, also backwards.
        optional stroke: Length, in Range::above(0.0);
        /// Beside stroke: how far it goes backwards from where it is drawn, which is then no end stop.
        optional stroke_back: Length, in Range::above(0.0);
        /// With input, of a rigid wall that only turns: how far, from where it is drawn, which is one end stop, to the other; left out with input = "speed": any number of turns, both ways.
        optional swing: Angle, in Range::above(0.0);
        /// Beside swing: how far it turns backwards from where it is drawn, which is then no end stop.
        optional swing_back: Angle, in Range::above(0.0);
    }
}

choice! {
    /// What of a wall's motion is an input.
    DriveWord {
        /// its speed, wall.NAME.speed, from minus to plus the full one: a conveyor's or a drum's motor
        "speed" => Speed,
        /// where it is, wall.NAME.position (of one that only turns wall.NAME.angle), which it goes to at full speed, or steadily where the input has a slope (in `sandgate run`: a linear schedule): a piston, a flap. Give velocity as the speed it should have
        "position" => Position,
    }
}

choice! {
    /// What moves of a wall that has a velocity.
    MotionWord {
        /// its surface slides along itself and the wall stays where it is: a conveyor belt
        "belt" => Belt,
        /// the wall moves as a whole: a piston, a falling floor, a drum. Walls that it slides along go on past it by four spacings, or what is in the corner gets out
        "rigid" => Rigid,
    }
}

table! {
    /// A plate that slides along its own length. Its face runs from `from` to `to` with material on the left (in space on the side of span x (to - from), where an inflow's is the other); opening o uncovers the share o next to `from`, and the plate retracts towards `to`: what of it has passed `to` is no longer there, as if it went into a wall.
    RawGate {
        /// End that opens first.
        required from: Coordinates<Length>;
        /// End towards which the plate retracts.
        required to: Coordinates<Length>;
        /// In space: the vector along which the face is extruded.
        optional span: Coordinates<Length>;
        /// Depth of the plate behind its face, at least 4 spacings; 4 spacings if left out.
        optional thickness: Length, in Range::above(0.0);
        /// Largest speed of the plate. Above c0/7 (with courant 0.7) it may be held to that: it moves 0.1 h a step at most. With grains in an opening w it closes at w sqrt(g/thickness) at most, where there is gravity, and is `blocked` then.
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
    /// A source: rows of particles enter through the face from `from` to `to`, on its left side, at a set velocity. A fluid whose face lies on a wall that stands still (on the whole of its length, as a pipe or a channel that ends in the wall) is pushed in: what stands before the face, a stream as deep as it or a pool over it, is pressed on and gives way, until it is squeezed by 2 % (0.02 rho c0^2; `numerics.expected_speed` sets c0), as in a tank that is full. Anything else comes in only where a spacing before the face is free: beside material that stands before a part of the face the rest lets in what is due, and a source under material, or that a gate or a moving wall covers, is blocked. A fluid's face away from walls has the pressure of free room, and its speed does not push on what is before it: into a stream as deep as the face comes what a reservoir with its surface at the top of the face would feed. What has come in is behind the rate by up to one row, of a stream that pushes by another while it gathers speed, which comes after also when the rate falls or goes to 0; what is pending of a row waits, with the rate at 0, until it is above 0 again. While the source is blocked, or gathers speed for longer than a row takes, one row stays due, and what is asked for beyond it is lost, as is, but for a stream that pushes, the row itself when the rate goes to 0 meanwhile. Who needs an amount watches the output inflow.NAME.mass, what has come in, and not the sum of the rate over time.
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
        /// Rate at the start; at most what the face lets in at that velocity, the density times its area times the velocity across it.
        optional rate: MassRate, in Range::from(0.0), default 0;
    }
}

table! {
    /// Where particles are taken out and counted: a box, or all that is outside of the domain.
    RawOutflow {
        /// Lower corner of a box.
        optional lower: Coordinates<Length>;
        /// Upper corner.
        optional upper: Coordinates<Length>;
        /// true: whatever leaves the domain, other than by a periodic side, is taken out; without such an outflow that is an error.
        optional outside: Flag;
    }
}
