"""A beam that is blocked while a small plan is measured: every point is there, and not one is wrong."""

from pathlib import Path
from typing import Any

import numpy as np

from catseye.app.store.catalog import resolve_run
from catseye.app.store.reader import RunReader
from tests.system.blocking import misfits_um, random_blocks, run_blocked, still_truth
from tests.system.command import emulated, last_run
from tests.system.test_ways_of_following import ALL_THETA2, FEW_NODES

_SPEED = "100"
_STEPS = 24 + 2

NODES = {**FEW_NODES, ALL_THETA2: "theta2_deg = [20.0, 40.0, 60.0]"}


def stored(folder: Path) -> RunReader:
    return RunReader(resolve_run(folder / "catseye-runs", last_run(folder, "open-loop")))


def test_a_beam_blocked_now_and_then_spoils_no_point(tmp_path: Path) -> None:
    truth = still_truth(tmp_path, {"P2": (680.0, 0.0)})
    options = ("--speed", _SPEED, "--truth", str(truth))
    with emulated(tmp_path, *options, edit=NODES, module="tests.system.still_bench") as bench:
        blocks = random_blocks(seed=4, count=4, steps=_STEPS, lasting=1)
        story = run_blocked(
            bench, blocks, _SPEED, "--search", "none", "--param", 'reflectors=["P2"]', "--param", "off_node=0"
        )
        arm: dict[str, Any] = bench.ask(op="truth")["truth"]
    assert story.code == 0, story.stderr
    record = stored(tmp_path)
    points = record.rows("points")
    assert len(points) == 24
    assert np.abs(misfits_um(points, arm)).max() < 1.0
    lost = [event for event in record.events() if event.kind == "beam-lost"]
    assert len(lost) >= 3
    assert len({point["segment"] for point in points}) >= 3
