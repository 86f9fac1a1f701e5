"""The real-time driver on an emulated arm in virtual time: what the beam misses before and after lags are known."""

from dataclasses import replace

import numpy as np

from catseye.drivers.roles.pose import Pose
from catseye.simulators.config import ErrorBudget
from catseye.simulators.melfa.mxt import MxtOptions
from tests.streamed_bench import VirtualArm, cell_and_config, driven, following_mm
from tests.unit.procedures.benches import Floats
from tests.unit.simulators.benches import P2, aimed


def way(first: Pose, last: Pose, parts: int = 120) -> tuple[Pose, ...]:
    """Return aimed targets between two poses, straight in J1 and J2."""
    shares = np.linspace(0.0, 1.0, parts + 1)[1:]
    return tuple(
        aimed(*(a + share * (b - a) for a, b in zip(first[:2], last[:2], strict=True))) for share in shares
    )


async def missed_mm(lag_spread_s: float, **settings: object) -> list[float]:
    """Lead the arm there, back and there again; return what the beam misses on each way."""
    start, end = aimed(-50.0, 20.0), aimed(-45.0, 30.0)
    config = replace(cell_and_config(1)[1], start_joints=start, budget=ErrorBudget.none())
    arm = VirtualArm(config, MxtOptions(lag_spread_s=lag_spread_s), settings)
    found: list[float] = []
    async with driven(arm) as robot:
        for targets in (way(start, end), way(end, start), way(start, end)):
            arm.passed.clear()
            await robot.follow(targets)
            passed: Floats = np.array([*arm.passed, targets[-1]])
            found.append(following_mm(passed, {"P2": (P2.x_mm, P2.y_mm)}))
    return found


async def test_the_first_way_teaches_what_later_ones_need() -> None:
    first, *later = await missed_mm(0.0002)
    assert max(later) < 0.3 * first


async def test_larger_differences_of_lag_are_learned_too() -> None:
    first, *later = await missed_mm(0.002)
    assert max(later) < 0.1 * first


async def test_nothing_is_made_up_for_when_switched_off() -> None:
    first, *later = await missed_mm(0.0002, most_lead_ms=0.0)
    assert min(later) > 0.8 * first
