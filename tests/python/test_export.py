"""Exported tables and pictures, read by others' readers and compared with the log.

SANDGATE_CSV, SANDGATE_PARQUET, SANDGATE_VTK (folder), SANDGATE_LOG, SANDGATE_PROGRAM
"""

import csv
import os
import pathlib
import re
import struct
import subprocess
import xml.etree.ElementTree as ElementTree

import numpy as np
import pyarrow.parquet
import pytest
from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer
from mcap_protobuf.decoder import DecoderFactory


def test_parquet_has_the_same_bits_as_the_table():
    with open(os.environ["SANDGATE_CSV"]) as stream:
        rows = list(csv.DictReader(stream))
    file = pyarrow.parquet.ParquetFile(os.environ["SANDGATE_PARQUET"])
    table = file.read()
    assert table.num_rows == len(rows) == 41
    assert set(rows[0]) | {"step"} == set(table.column_names)
    for name in rows[0]:
        assert [float(row[name]) for row in rows] == table.column(name).to_pylist(), name
    assert table.column("step").to_pylist() == list(range(41))
    notes = file.metadata.metadata
    assert notes[b"unit.gauge.level.depth"] == b"m"
    assert notes[b"unit.gauge.load.force_y"] == b"N" and notes[b"unit.time"] == b"s"


def clouds():
    """Time and particles of each snapshot in the log."""
    with open(os.environ["SANDGATE_LOG"], "rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        for _, _, message, cloud in reader.iter_decoded_messages(topics=["sandgate/v1/small_silo/out/particles"]):
            names = [field.name for field in cloud.fields]
            points = np.frombuffer(cloud.data, "<f4").reshape(-1, len(names))
            yield message.log_time / 1e9, dict(zip(names, points.T))


def vtp(path):
    """Points, cells and values of a file, read by the published layout of VTK's XML files."""
    raw = path.read_bytes()
    head, _, tail = raw.partition(b'<AppendedData encoding="raw">\n_')
    root = ElementTree.fromstring(head + b"</VTKFile>")
    assert root.attrib["type"] == "PolyData" and root.attrib["header_type"] == "UInt64"
    kinds = {"Float32": "<f4", "Int64": "<i8"}

    def array(node):
        offset = int(node.attrib["offset"])
        (size,) = struct.unpack_from("<Q", tail, offset)
        values = np.frombuffer(tail[offset + 8 : offset + 8 + size], kinds[node.attrib["type"]])
        return values.reshape(-1, int(node.attrib["NumberOfComponents"]))

    piece = root.find("PolyData/Piece")
    values = {
        f"{section.tag}/{node.attrib['Name']}": array(node) for section in piece for node in section.iter("DataArray")
    }
    return {key: int(piece.attrib[f"NumberOf{key}"]) for key in ("Points", "Verts", "Lines", "Polys")}, values


def collection(name):
    folder = pathlib.Path(os.environ["SANDGATE_VTK"])
    root = ElementTree.parse(folder / name).getroot()
    return [(float(d.attrib["timestep"]), folder / d.attrib["file"]) for d in root.iter("DataSet")]


def test_particles_are_those_of_the_log():
    files = collection("particles.pvd")
    snapshots = list(clouds())
    assert len(files) == len(snapshots) == 5
    for (time, path), (logged, fields) in zip(files, snapshots):
        assert time == logged
        counts, values = vtp(path)
        count = len(fields["x"])
        assert counts == {"Points": count, "Verts": count, "Lines": 0, "Polys": 0}
        assert (values["Points/Points"] == np.stack([fields[k] for k in "xyz"], 1)).all()
        assert (values["PointData/velocity"] == np.stack([fields[k] for k in ("vx", "vy", "vz")], 1)).all()
        for name in ("pressure", "inertial_number", "phase", "asleep"):
            assert (values[f"PointData/{name}"][:, 0] == fields[name]).all()
        assert (values["Verts/offsets"][:, 0] == np.arange(1, count + 1)).all()


def test_the_gate_is_where_it_was():
    lefts = []
    for _, path in collection("walls.pvd"):
        counts, values = vtp(path)
        assert counts["Lines"] + counts["Polys"] == len(values["CellData/kind"])
        kind = values["CellData/kind"][:, 0]
        assert {0.0, 1.0, 3.0, 4.0} == set(kind)
        of_polys = kind[counts["Lines"] :]
        corners = values["Polys/connectivity"][:, 0].reshape(-1, 4)[of_polys == 1.0]
        lefts.append(values["Points/Points"][corners.ravel(), 0].min())
    # Closed, it begins at 2.4 cm; open, it has moved by its own width of 3.2 cm.
    assert abs(lefts[0] - 0.024) < 1e-6
    assert abs(lefts[2] - 0.056) < 1e-6
    assert re.fullmatch(r"walls-\d{6}\.vtp", collection("walls.pvd")[0][1].name)


@pytest.mark.parametrize("method", [CompressionType.ZSTD, CompressionType.LZ4])
def test_a_log_that_somebody_compressed_is_refused_with_what_to_do(method, tmp_path):
    path = tmp_path / "small.mcap"
    with open(os.environ["SANDGATE_LOG"], "rb") as stream, open(path, "wb") as copy:
        writer = Writer(copy, compression=method)
        writer.start()
        channels = {}
        for schema, channel, message in make_reader(stream).iter_messages(log_time_order=False):
            if channel.id not in channels:
                known = writer.register_schema(schema.name, schema.encoding, schema.data)
                channels[channel.id] = writer.register_channel(channel.topic, channel.message_encoding, known, channel.metadata)
            writer.add_message(channels[channel.id], message.log_time, message.data, message.publish_time, message.sequence)
        writer.finish()
    for verb in (["log", "info"], ["log", "cat"], ["log", "redrive", "--check"], ["log", "export", "--csv", tmp_path / "g.csv"]):
        done = subprocess.run([os.environ["SANDGATE_PROGRAM"], *verb, path], capture_output=True, text=True)
        assert done.returncode == 5 and "mcap decompress" in done.stderr, (verb, done.stdout, done.stderr)
    for _ in range(2):  # The first one leaves nothing that would be in the way of the second.
        done = subprocess.run([os.environ["SANDGATE_PROGRAM"], "log", "recover", path, tmp_path / "to.mcap"], capture_output=True, text=True)
        assert done.returncode != 0 and "mcap decompress" in done.stderr, done.stderr
        assert os.listdir(tmp_path) == ["small.mcap"]
