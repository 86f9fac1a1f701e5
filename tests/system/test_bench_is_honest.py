"""The emulated bench is no kinder than reality: what the plan leaves out, the measurement shows."""

import json
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from catseye.calibration.core.types import Floats
from tests.system.command import SPEED, Emulated, catseye, emulated, last_run

FEW_NODES = {
    "theta1_deg = [-140.0, -120.0, -100.0, -80.0, -60.0, -40.0, -20.0, 0.0, 20.0, 40.0, 60.0]": (
        "theta1_deg = [-80.0, -60.0, -40.0, -20.0]"
    ),
    "theta2_deg = [0.0, 20.0, 40.0, 60.0, 80.0, 100.0, 120.0, 140.0]": "theta2_deg = [20.0, 50.0, 80.0, 110.0]",
}


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Emulated]:
    folder = tmp_path_factory.mktemp("honest")
    with emulated(folder, "--seed", "3", edit=FEW_NODES) as running:
        searched = catseye("run", "reflector-search", "--cell", running.cell, "--speed", SPEED, cwd=folder)
        assert searched.returncode == 0, searched.stderr
        yield running


@pytest.fixture(scope="module")
def tracked(bench: Emulated) -> dict[str, Any]:
    """Return the facts of a measurement as it is planned."""
    return measure(bench)


def measure(bench: Emulated, *params: str) -> dict[str, Any]:
    folder = bench.cell.parent
    options = [part for text in params for part in ("--param", text)]
    done = catseye("run", "open-loop", "--cell", bench.cell, "--speed", SPEED, *options, cwd=folder)
    assert done.returncode == 0, done.stderr
    shown = catseye("show", last_run(folder, "open-loop"), "--json", cwd=folder)
    facts: dict[str, Any] = json.loads(shown.stdout)
    return facts


def lost(facts: dict[str, Any]) -> int:
    return sum(event["kind"] == "beam-lost" for event in facts["events"])


def reversal_mdeg(bench: Emulated, facts: dict[str, Any]) -> tuple[Floats, Floats]:
    """Return the identified reversal error at the J2 nodes and its standard uncertainty, from the covariance."""
    folder = bench.cell.parent
    output = folder / "result.json"
    done = catseye("identify", facts["run"], "-o", output, cwd=folder)
    assert done.returncode == 0, done.stderr
    result = json.loads(output.read_text())
    table, covariance = result["theta2_map"], result["covariance"]
    matrix = np.array(covariance["matrix"])
    nodes = [f"{node:g}" for node in table["node_deg"]]
    plus, minus = ([covariance["names"].index(f"Δθ2({node}°, {sign})") for node in nodes] for sign in "+−")
    variance = matrix[plus, plus] + matrix[minus, minus] - 2.0 * matrix[plus, minus]
    difference: Floats = np.array(table["negative_mdeg"]) - np.array(table["positive_mdeg"])
    return difference, 1e3 * np.rad2deg(np.sqrt(variance))


def true_reversal_mdeg(bench: Emulated) -> Floats:
    table = bench.ask(op="truth")["truth"]["theta2_map"]
    both = np.array(table["negative_mdeg"]) - np.array(table["positive_mdeg"])
    at_nodes: Floats = np.interp([20.0, 50.0, 80.0, 110.0], table["node_deg"], both)
    return at_nodes


def test_planned_tracking_keeps_the_beam_on_every_move(tracked: dict[str, Any]) -> None:
    assert lost(tracked) == 0
    assert tracked["counts"]["points"] == 3 * (8 * 8 + 6)


def test_point_to_point_without_subdivision_breaks_the_beam(bench: Emulated) -> None:
    facts = measure(bench, "subdivide=false", 'reflectors=["P2"]')
    assert lost(facts) > 40


def test_identified_reversal_is_the_true_one_with_take_up(bench: Emulated, tracked: dict[str, Any]) -> None:
    found, u = reversal_mdeg(bench, tracked)
    assert u.max() < 1.5
    assert (np.abs(found - true_reversal_mdeg(bench)) / u).max() < 4.0


def test_reversal_without_take_up_shifts_the_map(bench: Emulated) -> None:
    found, u = reversal_mdeg(bench, measure(bench, "take_up=false"))
    true = true_reversal_mdeg(bench)
    # The sweep turns at the first and the last node: the second visit stays on the flank of the first.
    off = np.abs(found - true) / u
    assert np.abs(found[[0, -1]]).max() < 5.0
    assert off[[0, -1]].min() > 10.0
    assert off[1:-1].max() < 4.0
