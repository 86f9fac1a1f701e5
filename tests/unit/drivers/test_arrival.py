"""Where a motion that is over has ended: what a controller reads back beside its command."""

import pytest

from catseye.drivers.links.arrival import require_arrived
from catseye.drivers.roles.errors import NotArrivedError
from tests.unit.drivers.abb_rig import rig
from tests.unit.simulators.abb.benches import BENT

TARGET = (2.0, *BENT[1:])


@pytest.mark.parametrize("readback_deg", [0.05, 0.08])
async def test_a_controller_may_read_back_beside_its_command(readback_deg: float) -> None:
    # Five standard deviations, and more.
    async with rig(tolerance_deg=0.4) as one:
        one.bench.bench.readback_deg = readback_deg
        await one.robot.move_joints(TARGET)
        off = [abs(a - b) for a, b in zip(await one.robot.joints(), TARGET, strict=True)]
        assert 0.01 < max(off) < one.robot.read_back_limit == 0.4


@pytest.mark.parametrize("readback_deg", [0.05, 0.08])
async def test_a_motion_that_ends_elsewhere_names_the_setting(readback_deg: float) -> None:
    async with rig(tolerance_deg=0.001) as one:
        one.bench.bench.readback_deg = readback_deg
        with pytest.raises(NotArrivedError, match=r"tolerance_deg = 0\.001.*larger .*\[robot\.settings\]"):
            await one.robot.move_joints(TARGET)


def test_the_farthest_joint_is_named_with_both_angles() -> None:
    with pytest.raises(NotArrivedError, match=r"robot: .*J2 is read back at 20\.060° instead of 20\.000°"):
        require_arrived("robot", ("J1", "J2", "J3"), (10.04, 20.06, 30.0), (10.0, 20.0, 30.0), 0.05)
    require_arrived("robot", ("J1", "J2", "J3"), (10.04, 20.04, 30.0), (10.0, 20.0, 30.0), 0.05)


async def test_a_real_irb_120_arrives_as_it_is_delivered() -> None:
    """It reads back up to 0.05° beside its command."""
    async with rig() as one:
        assert one.robot.read_back_limit == pytest.approx(2 * 0.05)
