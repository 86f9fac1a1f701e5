"""A ball on the axis of a joint: what hands and indicators of the emulated bench make of it."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from catseye.simulators.config import AxisGaugeQuality, ErrorBudget
from catseye.simulators.emulated_bench import EmulatedBench
from catseye.simulators.world.scara.axis_errors import RadialError
from tests.unit.simulators.benches import QUIET
from tests.unit.simulators.control_port.test_session import Panel

PERFECT = AxisGaugeQuality(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 500.0, 0.0, 3600.0, 0.0)
START_DEG = (40.0, -30.0, 0.0, 0.0)


def panel(quality: AxisGaugeQuality, seed: int = 4) -> Panel:
    budget = replace(ErrorBudget.none(), radial_um=(6.0, 3.0, 0.0))
    config = replace(QUIET, seed=seed, budget=budget, start_joints=START_DEG, axis_gauge=quality)
    return Panel(EmulatedBench(config))


def read(bench: Panel, direction: str) -> float:
    found = bench.ask(op="indicator", direction=direction)["reading_um"]
    assert isinstance(found, float)
    return found


def refusal(bench: Panel, **request: object) -> str:
    return str(bench.ask(**request)["error"])


def from_the_zero(bench: Panel, joint: int) -> Any:
    """Return how far the ball moves when it is tapped by 100 µm, as x reads it."""
    bench.ask(op="mount_artefact", joint=joint)
    before = read(bench, "x")
    bench.ask(op="tap_artefact", by_um=100.0)
    return read(bench, "x") - before


@pytest.mark.parametrize("joint", [1, 2])
def test_indicators_see_the_motion_of_the_axis(joint: int) -> None:
    rng = np.random.default_rng([4, 3])
    motions = [RadialError(rng, rms_um) for rms_um in (6.0, 3.0)]
    shift_um = 1e3 * motions[joint - 1].shift_mm(np.array([START_DEG[joint - 1]]))[0]
    readings = {}
    for turned in (False, True):
        bench = panel(PERFECT)
        bench.ask(op="mount_artefact", joint=joint, turned=turned)
        readings[turned] = complex(read(bench, "x"), read(bench, "y"))
    # The zero of the indicators is the same; the other side sees the motion with the other sign.
    assert 0.5 * (readings[False] - readings[True]) == pytest.approx(shift_um)


def test_a_tap_moves_the_ball_along_the_indicator() -> None:
    assert from_the_zero(panel(PERFECT), 1) == pytest.approx(100.0)
    clumsy = [from_the_zero(panel(replace(PERFECT, tap_share=0.1), seed), 2) for seed in range(8)]
    assert np.std(clumsy) == pytest.approx(10.0, rel=0.8)


def test_form_and_scatter_are_in_the_readings() -> None:
    rough = replace(PERFECT, resolution_um=1.0, noise_um=2.0)
    bench = panel(rough)
    bench.ask(op="mount_artefact", joint=1)
    several = [read(bench, "x") for _ in range(40)]
    assert all(value == round(value) for value in several)
    assert np.std(several) == pytest.approx(2.0, rel=0.4)


def test_nothing_is_read_where_nothing_is_mounted() -> None:
    bench = panel(PERFECT)
    assert "no ball stands on the axis" in refusal(bench, op="indicator", direction="x")
    assert "a ball stands on the axis of J1 or of J2" in refusal(bench, op="mount_artefact", joint=4)
    bench.ask(op="mount_artefact", joint=1)
    bench.ask(op="tap_artefact", by_um=900.0)
    assert "beyond its range" in refusal(bench, op="indicator", direction="x")
    bench.ask(op="take_indicator_off")
    assert "no ball stands on the axis" in refusal(bench, op="tap_artefact", by_um=1.0)
