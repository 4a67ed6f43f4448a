"""Recovered logs: the reference reader takes them by their summary, with metadata, attachments and all messages.

SANDGATE_LOGS  the logs, separated as in PATH
"""

import os

import pytest
from mcap.reader import SeekingReader
from mcap_protobuf.decoder import DecoderFactory


@pytest.mark.parametrize("path", os.environ["SANDGATE_LOGS"].split(os.pathsep))
def test_the_reference_reader_reads_it_whole(path):
    with open(path, "rb") as stream:
        reader = SeekingReader(stream, validate_crcs=True, decoder_factories=[DecoderFactory()])
        statistics = reader.get_summary().statistics
        count = sum(1 for _ in reader.iter_decoded_messages())
        assert count == statistics.message_count > 0
        assert {m.name for m in reader.iter_metadata()} >= {"run", "segment", "recovered"}
        attachments = {a.name: a.data for a in reader.iter_attachments()}
        assert b'name = "small_silo"' in attachments["scene.toml"]
