"""The context of a procedure, with what stands behind it."""

from typing import NamedTuple

from catseye.app.engine.context import RunContext
from catseye.app.engine.control import RunControl
from catseye.app.engine.simulated_operator import SimulatedOperator
from catseye.app.errors import (
    LinkFailedError,
)
from catseye.app.store.reader import RunReader
from catseye.drivers.roles.robot import RobotStatus
from catseye.procedures.kit.records import Json
from catseye.procedures.kit.tasks import Task, TurnScrew
from tests.unit.app.engine.fakes import FakeBench

READY = RobotStatus(True, False, True, False, False, 20.0, 0, "")


class Willing(SimulatedOperator):
    """SimulatedOperator that do whatever they are asked, or break."""

    async def do(self, task: Task) -> dict[str, Json]:
        if isinstance(task, TurnScrew):
            raise LinkFailedError("the screw is stuck")
        return {"did": task.do}


class Parts(NamedTuple):
    bench: FakeBench
    ctx: RunContext
    control: RunControl
    reader: RunReader
