"""The driver after a point that the emulated controller refuses, until an operator has restarted the program."""

import pytest

from catseye.drivers.kuka.robot import KukaVarproxy
from catseye.drivers.roles.clock import SystemClock
from catseye.drivers.roles.errors import NotReadyError
from tests.unit.simulators.kuka.benches import UPRIGHT, kuka_bench

BEYOND = (190.0, *UPRIGHT[1:])
"""The software limit of A1 is 185 deg."""


async def test_a_refused_point_says_the_way_on_which_works() -> None:
    async with kuka_bench() as bench:
        robot = KukaVarproxy.at(bench.endpoints[0].endpoint, SystemClock())
        try:
            await robot.connect()
            with pytest.raises(NotReadyError, match=r"software limit.*confirm .*reset and start CATSKUKA"):
                await robot.move_joints(BEYOND)
            assert bench.bench.joints == UPRIGHT
            status = await robot.status()
            assert (status.alarm_number, status.operation_enabled) == (1, False)
            with pytest.raises(NotReadyError, match="reset and start CATSKUKA"):
                await robot.step_axis("A6", 0.01)
            for key in ("confirm", "reset", "start"):
                bench.controller.press(key)
            await robot.step_axis("A6", 0.01)
            assert bench.bench.joints[5] == pytest.approx(0.01, abs=1e-6)
        finally:
            await robot.close()
