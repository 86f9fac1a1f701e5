"""A laser tracker beside a SCARA: what its driver says of where the arm stands, and of what hides it."""

import math
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from catseye.drivers.leica.tracker import LeicaEmscon
from catseye.drivers.roles.clock import SystemClock
from catseye.drivers.roles.errors import HiddenTargetError
from catseye.simulators.config import EmulatedDevice
from catseye.simulators.control_port.client import ask
from catseye.simulators.control_port.exchange import RefusedRequestError
from catseye.simulators.control_port.faults import BlockBeam
from catseye.simulators.control_port.messages import ClearBeam
from catseye.simulators.control_port.survey_messages import LeadTracker
from catseye.simulators.emulated_bench import EmulatedBench
from tests.unit.simulators.benches import QUIET

SPEED = 50.0


@asynccontextmanager
async def beside(*, initialised: bool) -> AsyncIterator[tuple[EmulatedBench, LeicaEmscon, str]]:
    device = EmulatedDevice("tracker", "leica-emscon", options={"initialised": initialised})
    async with EmulatedBench(replace(QUIET, devices=(device,), speed=SPEED)) as bench:
        tracker = LeicaEmscon.at(bench.endpoints[0].endpoint, SystemClock(SPEED), plane_dwell_s=1.0)
        try:
            await tracker.connect()
            yield bench, tracker, bench.endpoints[-1].endpoint
        finally:
            await tracker.close()


def residuals_mm(places: NDArray[np.complex128], seen: NDArray[np.complex128]) -> NDArray[np.float64]:
    """Return what the best turn and shift of a plane leaves (complex least squares, turn of length 1)."""
    one, other = places - places.mean(), seen - seen.mean()
    turn = np.vdot(one, other)
    return np.asarray(np.abs(other - turn / abs(turn) * one))


async def test_the_tracker_sees_the_arm_in_a_turned_plane() -> None:
    async with beside(initialised=True) as (bench, tracker, control):
        await ask(control, LeadTracker(target="arm"))
        commands = [(10.0, 20.0), (-20.0, 80.0), (40.0, 60.0), (0.0, 110.0), (25.0, 15.0)]
        true, seen = [], []
        for j1_deg, j2_deg in commands:
            bench.bench.move_to((j1_deg, j2_deg, 50.0, 0.0))
            bench.bench.advance_to(bench.bench.standstill_s + 2.0)
            found = await tracker.locate()
            assert 0.005 < found.u_mm < 0.1
            true.append(complex(*bench.bench.tracked_mm))
            seen.append(complex(found.x_mm, found.y_mm))
        # Five standard deviations of a coordinate.
        assert residuals_mm(np.array(true), np.array(seen)).max() < 0.08


@pytest.mark.parametrize("initialised", [True, False])
async def test_the_home_position_is_not_taken_for_the_arm(initialised: bool) -> None:
    async with beside(initialised=initialised) as (_bench, tracker, control):
        if not initialised:
            with pytest.raises(HiddenTargetError, match="home position"):
                await tracker.locate()
        await ask(control, LeadTracker(target="arm"))
        found = await tracker.locate()
        assert math.hypot(found.x_mm, found.y_mm) > 1000.0


async def test_what_stands_before_the_tracker_hides_the_arm() -> None:
    async with beside(initialised=True) as (_bench, tracker, control):
        await ask(control, LeadTracker(target="arm"))
        await tracker.locate()
        await ask(control, BlockBeam())
        with pytest.raises(HiddenTargetError):
            await tracker.locate()
        with pytest.raises(RefusedRequestError, match="finds no retroreflector"):
            await ask(control, LeadTracker(target="arm"))
        await ask(control, ClearBeam())
        await ask(control, LeadTracker(target="arm"))
        await tracker.locate()


async def test_the_column_hides_an_arm_behind_it() -> None:
    async with beside(initialised=True) as (bench, tracker, control):
        await ask(control, LeadTracker(target="arm"))
        # Seen from the tracker, some 2.3 m along x, the arm stretches out behind its column.
        bench.bench.move_to((170.0, 2.0, 50.0, 0.0))
        bench.bench.advance_to(bench.bench.standstill_s + 2.0)
        with pytest.raises(HiddenTargetError):
            await tracker.locate()


async def test_hands_know_no_other_retroreflector() -> None:
    async with beside(initialised=True) as (_bench, _tracker, control):
        with pytest.raises(RefusedRequestError, match="'N1'"):
            await ask(control, LeadTracker(target="N1"))
