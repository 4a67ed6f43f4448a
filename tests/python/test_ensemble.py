"""examples/ensemble: 32 members on two Dask workers have the bits of a serial run, and a killed worker costs a slice.

SANDGATE_PROGRAM, SANDGATE_LIBRARY: what packs, and what is packed. Run by tests/it/drivers.rs.
"""

import os
import signal
import sys
from pathlib import Path

import pyarrow.compute
import pyarrow.parquet
from dask.distributed import Client, LocalCluster

sys.path.insert(0, str(Path(os.environ["SANDGATE_ROOT"]) / "examples/ensemble"))

import sweep

SLICES = 32 * sweep.STEPS // sweep.SLICE


def test_a_killed_worker_changes_no_bit_and_costs_a_slice(tmp_path):
    archive = sweep.pack(os.environ["SANDGATE_PROGRAM"], os.environ["SANDGATE_LIBRARY"], tmp_path)
    assert len(sweep.members()) == 32
    serial = sweep.serial(archive)
    # The sweep sweeps: no two members give the same results.
    assert len({str(rows) for rows in serial.values()}) == 32

    store = sweep.Store(tmp_path / "members")
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
        Client(cluster) as client,
    ):
        before = client.run(os.getpid)
        assert len(before) == 2
        victim = next(iter(before.values()))

        def kill(slices):
            if slices == SLICES // 2:
                os.kill(victim, signal.SIGKILL)

        found = sweep.ensemble(client, archive, store, on_slice=kill)
        assert victim not in client.run(os.getpid).values(), "the worker was not killed"
        starts = [event for _, event in client.get_events("slices")]
        # Started again, everything is there: nothing is computed.
        again = sweep.ensemble(client, archive, store, on_slice=lambda slices: 1 / 0)
    assert found == serial and again == serial

    # No member went back behind its last saved state, and none did more than one slice twice: the one that the worker was
    # at, or had finished but not handed over.
    for number in serial:
        firsts = [start["first"] for start in starts if start["member"] == number]
        assert firsts == sorted(firsts)
        assert set(firsts) <= set(range(0, sweep.STEPS, sweep.SLICE))
        assert len(firsts) <= sweep.STEPS // sweep.SLICE + 1

    sweep.write_parquet(found, tmp_path / "results.parquet")
    table = pyarrow.parquet.read_table(tmp_path / "results.parquet")
    assert table.num_rows == 32 * sweep.STEPS
    last = table.filter(pyarrow.compute.field("time") == sweep.STEPS * sweep.STEP)
    column = 1 + sweep.OUTPUTS.index("outflow.drain.mass")
    assert last["outflow.drain.mass"].to_pylist() == [serial[n][-1][column] for n in range(32)]
    sweep.write_svg(found, tmp_path / "outflow.svg")
    assert (tmp_path / "outflow.svg").read_text().count("<polyline") == 32
