"""What the program left for each case: the reference reader reads it whole, and no mass is lost on any line.

SANDGATE_LOGS  the logs, separated as in PATH
"""

import os

import pytest
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory


@pytest.mark.parametrize("path", os.environ["SANDGATE_LOGS"].split(os.pathsep))
def test_the_whole_log_reads_and_mass_is_exact_on_every_line(path):
    kinds, masses = [], []
    with open(path, "rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        for schema, _, _, value in reader.iter_decoded_messages():
            kinds.append(schema.name)
            if schema.name == "sandgate.StepStats":
                masses.append(value.ledger)
        assert len(kinds) == reader.get_summary().statistics.message_count
        assert {m.name for m in reader.iter_metadata()} >= {"run", "end"}
    assert {"sandgate.Applied", "sandgate.Gauge", "sandgate.StepStats", "foxglove.PointCloud"} <= set(kinds)
    assert len(masses) == 4
    for mass in masses:
        assert mass.initial + mass.inflow - mass.outflow == mass.present
