"""What a real arm may drive that was walked, where it passes targets without standing still."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from catseye.app.engine.gate import MotionGate
from catseye.app.engine.walked.rule import WalkRule
from catseye.app.engine.walked.tube import Leg
from catseye.app.errors import UnwalkedError
from catseye.app.store.run_store import RunStore
from catseye.drivers.roles.device import Identity
from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.context import Prompt
from catseye.procedures.kit.records import Json
from tests.unit.app.engine.fakes import ARM, FakeRobot, ManualClock, free_way
from tests.unit.app.engine.walked.test_tube import AXES, CORNER, WALKED
from tests.unit.app.store.fakes import TickingClock


class SilentDesk:
    """Nobody is there."""

    async def ask(self, prompt: Prompt) -> str:
        raise AssertionError(prompt.id)

    async def event(self, kind: str, **data: Json) -> None:
        """Keep nothing."""


async def rule(root: Path, *, blended: bool) -> WalkRule:
    async def motions(_here: Pose) -> Sequence[Leg]:
        return []

    made = WalkRule(AXES, motions, lambda _arm: WALKED, blended)
    store = await RunStore.create(root, "open-loop", {}, TickingClock(), reserve_bytes=0)
    await made.begin(Identity("fake", "1.0", "7", False), CORNER[0], SilentDesk(), store)
    await store.abandon()
    return made


async def test_a_way_with_stops_beside_what_was_walked_passes(tmp_path: Path) -> None:
    (await rule(tmp_path, blended=False)).require(CORNER[0], CORNER[1:])


async def test_a_corner_cut_outside_of_what_was_walked_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UnwalkedError, match="was not walked"):
        (await rule(tmp_path, blended=True)).require(CORNER[0], CORNER[1:])


async def test_the_gate_refuses_a_motion_that_was_not_walked(tmp_path: Path) -> None:
    robot = FakeRobot(ManualClock())
    robot.state = replace(robot.state, servo_on=True, override_percent=20.0, operation_enabled=True)
    robot.pose = CORNER[0]
    gate = MotionGate(robot, ARM.axes, free_way, 20.0)
    await gate.require(*CORNER[1:])
    gate.walk_rule = await rule(tmp_path, blended=True)
    with pytest.raises(UnwalkedError, match="was not walked"):
        await gate.require(*CORNER[1:])
