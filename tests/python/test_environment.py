"""The packages of requirements.txt import: a broken environment is named here, not in some other test."""

import importlib

import pytest


@pytest.mark.parametrize("name", ["fmpy", "mcap.reader", "mcap_protobuf.decoder", "zenoh", "rerun", "numpy"])
def test_package_imports(name):
    importlib.import_module(name)
