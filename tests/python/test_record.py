"""Logs as others see them: the reference reader, Foxglove's own schemas, Rerun.

SANDGATE_LOG       a finished log of a small silo
SANDGATE_SCHEMAS   a folder with the schema of each message as a FileDescriptorSet, `<full name>.fds`
SANDGATE_CUT       the file that a killed process left
SANDGATE_KILLED_AT the wall clock when it was killed [s since 1970]
"""

import math
import os
import pathlib
import struct
import subprocess
import sys

import numpy as np
import pytest
from foxglove_schemas_protobuf import (
    FrameTransform_pb2,
    Log_pb2,
    PointCloud_pb2,
    SceneUpdate_pb2,
)
from google.protobuf import descriptor_pb2, descriptor_pool
from google.protobuf.unknown_fields import UnknownFieldSet
from mcap.exceptions import EndOfFile
from mcap.reader import NonSeekingReader, make_reader
from mcap.stream_reader import StreamReader
from mcap_protobuf.decoder import DecoderFactory

LOG = pathlib.Path(os.environ["SANDGATE_LOG"])
SCHEMAS = pathlib.Path(os.environ["SANDGATE_SCHEMAS"])
STEPS = 40
FOXGLOVE = {
    "foxglove.Log": Log_pb2,
    "foxglove.PointCloud": PointCloud_pb2,
    "foxglove.SceneUpdate": SceneUpdate_pb2,
    "foxglove.FrameTransform": FrameTransform_pb2,
}


def decoded(path, reader=make_reader):
    with open(path, "rb") as stream:
        for schema, channel, message, value in reader(
            stream, decoder_factories=[DecoderFactory()]
        ).iter_decoded_messages():
            yield schema.name, channel, message, value


def of(name):
    return [(c, m, v) for schema, c, m, v in decoded(LOG) if schema == name]


def shape(descriptor, seen=None):
    """Everything of a message that decides how its bytes are read, through all messages it refers to."""
    seen = {} if seen is None else seen
    if descriptor.full_name not in seen:
        seen[descriptor.full_name] = None
        seen[descriptor.full_name] = [
            (
                f.number,
                f.name,
                f.type,
                f.is_repeated,
                f.message_type.full_name if f.message_type else "",
                [(v.name, v.number) for v in f.enum_type.values] if f.enum_type else [],
                f.enum_type.full_name if f.enum_type else "",
            )
            for f in sorted(descriptor.fields, key=lambda f: f.number)
        ]
        for field in descriptor.fields:
            if field.message_type:
                shape(field.message_type, seen)
    return seen


def ours(name):
    files = descriptor_pb2.FileDescriptorSet.FromString(
        (SCHEMAS / f"{name}.fds").read_bytes()
    ).file
    by_name = {file.name: file for file in files}
    pool = descriptor_pool.DescriptorPool()

    def add(file):
        for needed in file.dependency:
            if needed in by_name:
                add(by_name.pop(needed))
        pool.Add(file)

    while by_name:
        add(by_name.popitem()[1])
    return pool.FindMessageTypeByName(name)


@pytest.mark.parametrize("name", sorted(FOXGLOVE))
def test_schemas_are_those_that_foxglove_publishes(name):
    theirs = FOXGLOVE[name].DESCRIPTOR.message_types_by_name[name.split(".")[1]]
    assert shape(ours(name)) == shape(theirs)


def test_the_whole_file_reads_and_every_message_decodes():
    with open(LOG, "rb") as stream:
        summary = make_reader(stream).get_summary()
    counted = 0
    expected = {}
    for schema, channel, message, value in decoded(LOG):
        counted += 1
        assert schema == value.DESCRIPTOR.full_name
        assert channel.topic.startswith("sandgate/v1/small_silo/")
        assert channel.metadata["encoding"] == f"application/protobuf;{schema}"
        assert message.sequence == expected.get(channel.id, 0)
        expected[channel.id] = message.sequence + 1
        # The schema describes all that was written.
        assert len(UnknownFieldSet(value)) == 0
    assert counted == summary.statistics.message_count > 500
    # Non-seeking readers see the same.
    assert counted == sum(1 for _ in decoded(LOG, NonSeekingReader))


def test_metadata_and_attachments_make_the_file_whole():
    with open(LOG, "rb") as stream:
        reader = make_reader(stream)
        metadata = {m.name: m.metadata for m in reader.iter_metadata()}
        attachments = {a.name: a.data for a in reader.iter_attachments()}
    assert metadata["run"]["scene"] == "small_silo"
    assert len(metadata["run"]["scene_hash"]) == 64
    assert metadata["end"]["reason"] == "finished"
    assert metadata["end"]["dropped"] == "0"
    assert len(metadata["end"]["state_hash"]) == 64
    assert b"small_silo" in attachments["scene.toml"]


def test_first_records_are_the_run_and_its_scene():
    with open(LOG, "rb") as stream:
        kinds = [type(r).__name__ for r in StreamReader(stream).records]
    assert kinds[:4] == ["Header", "Metadata", "Metadata", "Attachment"]


def test_mass_is_exact_on_every_line():
    lines = of("sandgate.StepStats")
    assert len(lines) == STEPS + 1
    for _, _, stats in lines:
        mass = stats.ledger
        assert mass.initial > 0
        assert mass.initial + mass.inflow - mass.outflow == mass.present
        assert math.isfinite(stats.kinetic_energy)
    assert lines[-1][2].ledger.outflow > 0
    assert [s.step for _, _, s in lines] == list(range(STEPS + 1))


def test_gauges_carry_unit_step_and_the_time_of_the_message():
    gauges = of("sandgate.Gauge")
    by_name = {}
    for channel, message, gauge in gauges:
        by_name.setdefault(gauge.name, []).append(gauge)
        assert message.log_time == round(gauge.time * 1e9)
        assert message.log_time == gauge.timestamp.ToNanoseconds()
        assert channel.metadata["variable"] == gauge.name
        assert channel.metadata["unit"] == gauge.unit
        group, rest = gauge.name.split(".", 1)
        assert channel.topic == f"sandgate/v1/small_silo/out/{group}/{rest}"
    assert by_name["gauge.level.depth"][0].unit == "m"
    assert 0.04 < by_name["gauge.level.depth"][0].values[0] < 0.08
    assert len(by_name["gauge.surface.depth"][0].values) == 4
    assert by_name["gate.main.actual_opening"][-1].values[0] < 1
    assert max(g.values[0] for g in by_name["gauge.outlet.discharge"]) > 0


def test_applied_holds_the_bits_of_every_step():
    applied = [a for _, _, a in of("sandgate.Applied")]
    event = applied[0].Event
    assert applied[0].event == event.Value("INITIALIZE")
    steps = [a for a in applied if a.event == event.Value("STEP")]
    assert [a.step for a in steps] == list(range(1, STEPS + 1))
    f64 = lambda bits: struct.unpack("<d", struct.pack("<Q", bits))[0]
    for before, after in zip(steps, steps[1:]):
        assert f64(before.t_bits) + f64(before.h_bits) == f64(after.t_bits)
        assert before.t == f64(before.t_bits) and before.h == f64(before.h_bits)
    openings = [i for a in steps for i in a.inputs if i.name == "gate.main.opening"]
    assert openings and all(f64(i.bits[0]) == i.values[0] for i in openings)
    assert max(i.values[0] for i in openings) == 1.0


def test_particles_are_packed_as_their_fields_say():
    clouds = of("foxglove.PointCloud")
    assert [m.log_time for _, m, _ in clouds] == [k * 50_000_000 for k in range(5)]
    for _, _, cloud in clouds:
        kinds = np.dtype([(f.name, "<f4") for f in cloud.fields])
        assert [f.offset for f in cloud.fields] == [4 * i for i in range(10)]
        assert kinds.itemsize == cloud.point_stride
        points = np.frombuffer(cloud.data, kinds)
        assert 200 < len(points) <= 400
        for name in kinds.names:
            assert np.isfinite(points[name]).all(), name
        assert points["x"].min() > -0.03 and points["x"].max() < 0.11
        assert (points["z"] == 0).all()


def test_the_scene_is_drawn_and_the_gate_moves():
    (_, _, scene), = of("foxglove.SceneUpdate")
    entities = {e.id: e for e in scene.entities}
    assert {"wall.left", "wall.right", "gate.main", "outflow.drain"} <= set(entities)
    gate = entities["gate.main"]
    assert gate.frame_id == "gate.main"
    box = gate.cubes[0]
    assert box.size.x == pytest.approx(0.032)
    # The face is the segment y = 0 with material above it; the body is below.
    assert box.pose.position.x == pytest.approx(0.04)
    assert box.pose.position.y == pytest.approx(-box.size.y / 2)
    frames = [f for _, _, f in of("foxglove.FrameTransform")]
    opened = [f.translation.x for f in frames if f.child_frame_id == "gate.main"]
    assert opened[0] == 0 and 0.01 < max(opened) <= 0.032 + 1e-12


def test_a_killed_process_leaves_a_log_that_reads_to_the_last_second():
    written = 0
    kinds = set()
    with open(os.environ["SANDGATE_CUT"], "rb") as stream:
        try:
            for record in StreamReader(stream).records:
                kinds.add(type(record).__name__)
                written = max(written, getattr(record, "publish_time", 0))
        except EndOfFile:
            pass
    assert {"Metadata", "Attachment", "Schema", "Channel", "Message"} <= kinds
    # The recorder's bound is 0.75 s; a busy machine may run its thread later.
    assert float(os.environ["SANDGATE_KILLED_AT"]) - written * 1e-9 < 2


@pytest.mark.parametrize("colour", ["pressure", "phase"])
def test_rerun_shows_particles_by_what_was_chosen(colour, tmp_path):
    """examples/rerun_view.py: what it makes of a log is verified and counted by Rerun's own tools."""
    rrd = tmp_path / "silo.rrd"
    root = pathlib.Path(os.environ["SANDGATE_ROOT"])
    command = [sys.executable, root / "examples/rerun_view.py", LOG, "--colour", colour, "--save", rrd]
    subprocess.run(command, check=True, capture_output=True, text=True)
    rerun = pathlib.Path(sys.prefix) / "bin/rerun"
    verified = subprocess.run([rerun, "rrd", "verify", rrd], capture_output=True, text=True)
    assert verified.returncode == 0 and "1 file verified without error" in verified.stderr, verified.stderr
    said = subprocess.run([rerun, "rrd", "stats", rrd], capture_output=True, text=True).stdout
    # Walls, gate, drain, particles; four gauges with one value.
    for entity in ("/scene/particles", "/scene/gate/main", "/scene/wall/left", "/gauges/m/gauge.level.depth"):
        assert entity in said, said
