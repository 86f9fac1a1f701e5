"""Public clients of robot controllers."""

from collections.abc import Iterator
from typing import Any

import pytest

from catseye.app.testing.bench import RunningBench, bench_in_thread
from tests.peers.environment import said_by
from tests.unit.simulators.abb.benches import BENT, abb_config
from tests.unit.simulators.kuka.benches import UPRIGHT, kuka_config


@pytest.fixture
def kuka() -> Iterator[RunningBench]:
    with bench_in_thread(kuka_config()) as running:
        yield running


@pytest.fixture
def abb() -> Iterator[RunningBench]:
    with bench_in_thread(abb_config()) as running:
        yield running


def members(text: str) -> dict[str, float]:
    """Return the numbers of a structure."""
    parts = (part.split() for part in text.strip("{}").partition(": ")[2].split(", "))
    return {name: float(value) for name, value in parts}


def web(bench: RunningBench) -> str:
    return bench.endpoint("robot").replace("tcp", "http")


def test_py_openshowvar_reads_and_writes(kuka: RunningBench) -> None:
    said = said_by("kuka_variables.py", kuka.endpoint("robot").rpartition(":")[2])
    for name in ("axes", "measured"):
        axes = members(said.pop(name))
        assert [axes[f"A{n}"] for n in range(1, 7)] == pytest.approx(UPRIGHT, abs=1e-3)
    assert len(members(said.pop("place"))) >= 6
    assert said == {
        "reachable": True,
        "ping": "PONG",
        "proxy": "C3 BRIDGE INTERFACE",
        "override": ["20", "20"],
        "mode": "#EX",
        "unknown": None,
        "protected": None,
        "nonsense": None,
        "again": "20",
    }


def test_abb_robot_client_leads_the_controller(abb: RunningBench) -> None:
    said: dict[str, Any] = said_by("abb_controller.py", web(abb))
    assert said.pop("joints_deg") == pytest.approx(BENT, abs=1e-4)
    assert said.pop("place_mm") == pytest.approx([364.354, 0.0, 594.0], abs=1e-3)
    assert said.pop("goal_rad") == pytest.approx([0.1, 0.0, 0.0, 0.0, 0.5, 0.0], abs=1e-4)
    assert said.pop("refused") < -1_073_000_000
    assert said == {
        "execution": ["running", "forever"],
        "panel": ["motoron", "AUTO"],
        "task": ["started", True],
        "log": 1,
        "speed": 40.0,
        "digital": 1,
        "file": "MODULE peer",
        "files": ["peer.mod"],
        "stopped": "stopped",
        "started": ["running", "forever"],
    }


def test_rwsuis_leads_the_controller(abb: RunningBench) -> None:
    said = said_by("abb_rwsuis.py", web(abb))
    assert said.pop("goal").startswith("[[")
    assert said == {
        "panel": ["motoron", "AUTO"],
        "running": True,
        "stopped": "stopped",
        "off": "motoroff",
        "started": "running",
    }


def test_abb_motion_program_exec_starts_its_program(abb: RunningBench) -> None:
    said = said_by("abb_motion_program.py", web(abb))
    assert "must be stopped" in said["while_running"]
    assert said["complete"]
    assert any(name.startswith("motion_program") for name in said["file"]), said
