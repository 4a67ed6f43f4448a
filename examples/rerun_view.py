"""A log in Rerun: particles coloured by what you choose, walls and gates where they are, gauges as plots.

    sandgate run cases/silo_gate.toml
    pip install rerun-sdk mcap mcap-protobuf-support numpy
    python examples/rerun_view.py out/silo_gate/run.mcap                    # opens the viewer
    python examples/rerun_view.py out/silo_gate/run.mcap --colour pressure --save silo.rrd

Rerun opens a log as it is, too (`rerun run.mcap`): points of one colour, frames, messages. This reads the same file and
tells Rerun what the numbers mean.
"""

import argparse
import math

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

# Viridis, dark to bright, and colours that people with any eyes tell apart.
RAMP = np.array([[68, 1, 84], [70, 50, 126], [54, 92, 141], [39, 127, 142], [31, 161, 135], [74, 193, 109], [160, 218, 57], [253, 231, 37]])
KINDS = np.array([[0, 114, 178], [213, 94, 0], [0, 158, 115], [204, 121, 167], [230, 159, 0], [86, 180, 233]])
FIELDS = ["speed", "pressure", "inertial_number", "phase", "asleep"]


def messages(path):
    """Topic below the instance's name, time [s] and content of every message that is shown."""
    shown = {"foxglove.PointCloud", "foxglove.SceneUpdate", "foxglove.FrameTransform", "sandgate.Gauge"}
    with open(path, "rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        for schema, channel, message, value in reader.iter_decoded_messages():
            if schema.name in shown:
                yield channel.topic.split("/", 3)[3], message.log_time * 1e-9, schema.name, value


def particles(cloud):
    """Values of the particles by name."""
    points = np.frombuffer(cloud.data, np.dtype([(field.name, "<f4") for field in cloud.fields]))
    values = {name: points[name] for name in points.dtype.names}
    values["speed"] = np.sqrt(sum(values[axis] ** 2 for axis in ("vx", "vy", "vz")))
    return values


def colours(values, field, most):
    if field in ("phase", "asleep"):
        return KINDS[values[field].astype(int) % len(KINDS)]
    # Inertial numbers spread over decades: their root shows more.
    share = np.clip(values[field] / most, 0.0, 1.0) ** (0.5 if field == "inertial_number" else 1.0)
    place = share * (len(RAMP) - 1)
    low = np.minimum(place.astype(int), len(RAMP) - 2)
    part = (place - low)[:, None]
    return ((1.0 - part) * RAMP[low] + part * RAMP[low + 1]).astype(np.uint8)


def strips(entity):
    """Lines of an entity: outlines of boxes, and lines as they are."""
    lines = [[[p.x, p.y, p.z] for p in line.points] for line in entity.lines]
    for cube in entity.cubes:
        c, s = cube.pose.position, cube.size
        turn = 2.0 * math.atan2(cube.pose.orientation.z, cube.pose.orientation.w)
        corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5)]
        lines.append([
            [c.x + x * s.x * math.cos(turn) - y * s.y * math.sin(turn), c.y + x * s.x * math.sin(turn) + y * s.y * math.cos(turn), c.z]
            for x, y in corners
        ])
    return lines


def tell(path, field, radius):
    """Hands the log to Rerun; gives the units of gauges by where their plots are, and the first particles."""
    found = list(messages(path))
    clouds = [particles(value) for _, _, schema, value in found if schema == "foxglove.PointCloud"]
    if not clouds:
        raise SystemExit(f"{path} holds no particles (log.particles_every)")
    # One scale for all moments: 98 of 100 particles lie below its end.
    most = max(float(np.percentile(cloud[field], 98)) for cloud in clouds if len(cloud[field])) or 1.0
    for topic, time, schema, value in found:
        rr.set_time("simulated", duration=time)
        if schema == "foxglove.PointCloud":
            now = particles(value)
            flat = np.stack([now[axis] for axis in "xyz"], 1)
            rr.log("scene/particles", rr.Points3D(flat, colors=colours(now, field, most), radii=radius))
        elif schema == "foxglove.SceneUpdate":
            for entity in value.entities:
                if lines := strips(entity):
                    grey = [180, 60, 20] if entity.id.startswith("gate.") else [110, 110, 110]
                    rr.log(f"scene/{entity.id.replace('.', '/')}", rr.LineStrips3D(lines, colors=grey, radii=radius), static=True)
        elif schema == "foxglove.FrameTransform":
            move, turn = value.translation, value.rotation
            pose = rr.Transform3D(translation=[move.x, move.y, move.z], quaternion=[turn.x, turn.y, turn.z, turn.w])
            rr.log(f"scene/{value.child_frame_id.replace('.', '/')}", pose)
        elif topic.startswith("out/gauge/") and len(value.values) == 1:
            rr.log(f"gauges/{value.unit.replace('/', '_per_')}/{value.name}", rr.Scalars(value.values[0]))
    units = {f"gauges/{v.unit.replace('/', '_per_')}": v.unit for _, _, s, v in found if s == "sandgate.Gauge" and v.name.startswith("gauge.")}
    return units, clouds[0]


def eye(first):
    """In front of a planar scene; at a slant above one in space."""
    flat = np.stack([first[axis] for axis in "xyz"], 1)
    low, high = flat.min(axis=0), flat.max(axis=0)
    middle, size = (low + high) / 2.0, float(np.linalg.norm(high - low))
    if high[2] == low[2]:
        return rrb.EyeControls3D(position=middle + [0.0, 0.0, 1.1 * size], look_target=middle, eye_up=[0.0, 1.0, 0.0])
    return rrb.EyeControls3D(position=middle + [0.7 * size, -1.2 * size, 0.8 * size], look_target=middle, eye_up=[0.0, 0.0, 1.0])


def layout(units, first, field):
    """Particles at the left, one plot a unit at the right."""
    plots = [rrb.TimeSeriesView(origin=origin, name=f"gauges [{unit}]") for origin, unit in sorted(units.items())]
    scene = rrb.Spatial3DView(
        origin="scene", name=f"particles by {field.replace('_', ' ')}", background=[255, 255, 255],
        line_grid=rrb.LineGrid3D(visible=False), eye_controls=eye(first),
    )
    return rrb.Blueprint(rrb.Horizontal(scene, rrb.Vertical(*plots), column_shares=[3, 2]), collapse_panels=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("log", help="an MCAP log with particles")
    parser.add_argument("--colour", choices=FIELDS, default="speed", help="what colours the particles")
    parser.add_argument("--radius", type=float, default=None, help="radius of points [m]; else half of what lies between them")
    parser.add_argument("--save", metavar="FILE", help="write an .rrd file instead of opening the viewer")
    arguments = parser.parse_args()
    rr.init("sandgate", spawn=arguments.save is None)
    if arguments.save:
        rr.save(arguments.save)
    radius = arguments.radius or spacing(arguments.log) / 2.0
    rr.send_blueprint(layout(*tell(arguments.log, arguments.colour, radius), arguments.colour))


def spacing(path):
    """Distance of neighbours at the start [m]: of the first particle to the one that is nearest."""
    for _, _, schema, value in messages(path):
        if schema == "foxglove.PointCloud" and (now := particles(value)) and len(now["x"]) > 1:
            flat = np.stack([now[axis] for axis in "xyz"], 1)
            return float(np.sort(np.linalg.norm(flat - flat[len(flat) // 2], axis=1))[1])
    return 0.01


if __name__ == "__main__":
    main()
