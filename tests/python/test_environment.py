"""The packages of requirements.txt import: a broken environment is named here, not in some other test."""

import importlib

import pytest


NAMES = ["fmpy", "mcap.reader", "mcap_protobuf.decoder", "zenoh", "rerun", "numpy"]
NAMES += ["libcosimpy", "fmu_manipulation_toolbox", "pythonfmu.builder", "pythonfmu3.builder"]
NAMES += ["dask.distributed", "pyarrow.parquet", "matplotlib.pyplot", "playwright.sync_api"]


@pytest.mark.parametrize("name", NAMES)
def test_package_imports(name):
    importlib.import_module(name)
