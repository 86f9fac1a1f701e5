"""The driver in front of the emulated T2SA, over real loopback sockets."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from catseye.drivers.roles.clock import SystemClock
from catseye.drivers.roles.errors import (
    HiddenTargetError,
    LinkError,
    ProtocolError,
    RefusedError,
    WrongDeviceError,
)
from catseye.drivers.t2sa.tracker import T2sa
from catseye.simulators.config import Joints, Option
from catseye.simulators.emulated_bench import EmulatedSerialBench
from catseye.simulators.ports.lossy import Lossy
from tests.patience import until
from tests.unit.drivers.peers import loopback, settled
from tests.unit.simulators.trackers import near, tracker_bench
from tests.unit.simulators.world.serial.surveyed import FORWARD

SPEED = 50.0
FACING: Joints = (10.0, 10.0, -10.0, 70.0, -30.0, 40.0)
"""The plate with the marks faces the optical CMM."""

AWAY: Joints = (0.0, 10.0, -10.0, 0.0, 60.0, 0.0)


@dataclass
class Rig:
    """A driver and the bench behind it."""

    bench: EmulatedSerialBench
    tracker: T2sa

    def asked(self, line: str) -> int:
        """Return how often a line came."""
        return sum(entry.text == line for entry in self.bench.journal.entries("tracker"))

    async def reaches(self, line: str) -> None:
        """Wait until a line has come."""
        while not self.asked(line):  # noqa: ASYNC110  # the emulator tells nobody
            await asyncio.sleep(0.001)


@asynccontextmanager
async def rig(
    options: dict[str, Option] | None = None, start: Joints = FORWARD, speed: float = SPEED, **settings: Any
) -> AsyncIterator[Rig]:
    async with tracker_bench("t2sa", options=options, start=start, speed=speed) as bench:
        tracker = T2sa.at(bench.endpoints[0].endpoint, SystemClock(speed), **settings)
        try:
            assert (await tracker.connect()).simulated
            yield Rig(bench, tracker)
        finally:
            await tracker.close()


async def test_points_are_where_the_nests_are() -> None:
    async with rig(u_mm=0.02) as one:
        for name in ("nest1", "nest2", "world1"):
            found = await one.tracker.point(name, 0.0)
            np.testing.assert_allclose(found.place_mm, near(one.bench, name), atol=2e-6)
            assert found.u_mm == (0.02, 0.02, 0.02)


async def test_poses_are_those_of_the_artifacts() -> None:
    async with rig(start=FACING) as one:
        base, tool = await one.tracker.pose("base", 0.0), await one.tracker.pose("tool", 0.0)
        frames = []
        for pose in (base, tool):
            frame = np.eye(4)
            frame[:3, :3] = Rotation.from_euler("xyz", pose.turn_deg, degrees=True).as_matrix()
            frame[:3, 3] = pose.place_mm
            frames.append(frame)
        room, now = one.bench.bench.room, np.array([one.bench.bench.time_s])
        true = np.linalg.inv(room.base_at(now)[0]) @ room.frames_at(now)[0, -1]
        np.testing.assert_allclose(np.linalg.inv(frames[0]) @ frames[1], true, atol=1e-4)


async def test_a_frame_of_the_tool_stands_at_its_nest() -> None:
    async with rig(start=FACING) as one:
        flange, nest = await one.tracker.pose("tool", 0.0), await one.tracker.pose("nest2", 0.0)
        turned = Rotation.from_euler("xyz", flange.turn_deg, degrees=True)
        expected = np.array(flange.place_mm) + turned.apply(one.bench.bench.room.nests["nest2"].place_mm)
        np.testing.assert_allclose(nest.place_mm, expected, atol=1e-3)
        assert nest.turn_deg == pytest.approx(flange.turn_deg, abs=1e-4)


async def test_a_pose_has_the_uncertainties_of_the_settings() -> None:
    async with rig(start=FACING, u_mm=0.02, u_deg=0.01) as one:
        found = await one.tracker.pose("tool", 0.0)
    assert (found.u_mm, found.u_deg) == ((0.02, 0.02, 0.02), (0.01, 0.01, 0.01))


async def test_moving_axes_are_turned() -> None:
    async with rig(start=FACING) as one:
        fixed = await one.tracker.pose("tool", 0.0)
        other = T2sa.at(one.bench.endpoints[0].endpoint, SystemClock(SPEED), turns="moving-axes")
        await other.connect()
        moving = await other.pose("tool", 0.0)
        await other.close()
    expected = Rotation.from_euler("XYZ", fixed.turn_deg, degrees=True).as_matrix()
    found = Rotation.from_euler("xyz", moving.turn_deg, degrees=True).as_matrix()
    np.testing.assert_allclose(found, expected, atol=1e-5)


async def test_a_target_that_looks_away_is_hidden() -> None:
    async with rig(start=AWAY) as one:
        with pytest.raises(HiddenTargetError, match=r"nest1 is not seen .*ERR-305"):
            await one.tracker.point("nest1", 0.0)
        await one.tracker.point("world1", 0.0)


async def test_an_artifact_behind_somebody_is_hidden() -> None:
    async with rig(start=FACING) as one:
        one.bench.bench.cmm.block(None)
        with pytest.raises(HiddenTargetError, match="ERR-340"):
            await one.tracker.pose("tool", 0.0)


async def test_a_name_that_is_unknown_there_is_refused() -> None:
    async with rig() as one:
        with pytest.raises(RefusedError, match=r"ERR-306.*check its name in SpatialAnalyzer"):
            await one.tracker.point("other", 0.0)
        with pytest.raises(RefusedError, match="cannot be a name"):
            await one.tracker.point("a;b", 0.0)


async def test_the_second_face_is_refused() -> None:
    async with rig() as one:
        with pytest.raises(RefusedError, match="no single point in face 2"):
            await one.tracker.point("nest1", 0.0, None, 2)


async def test_a_dark_laser_is_reported_or_switched_on() -> None:
    async with rig({"laser_on": False}) as one:
        with pytest.raises(RefusedError, match=r"the laser is not ready \(LOFF\)"):
            await one.tracker.point("nest1", 0.0)
        assert not one.asked("!LST:1")
        examined = await one.tracker.examine()
        assert any("laser" in advice for advice in examined.advice)
    async with rig({"laser_on": False}, switches_laser_on=True) as one:
        await one.tracker.point("nest1", 0.0)
        assert one.asked("!LST:1") == 1
        assert one.bench.bench.time_s > 60.0


async def test_an_instrument_without_a_laser_is_asked_for_none() -> None:
    async with rig(start=FACING, has_laser=False) as one:
        await one.tracker.pose("tool", 0.0)
        assert (await one.tracker.examine()).facts == ("SpatialAnalyzer: Instrument is connected",)
        assert not one.asked("?LSTA")


async def test_a_busy_spatialanalyzer_is_waited_for() -> None:
    async with rig(speed=10.0) as one:
        other = T2sa.at(one.bench.endpoints[0].endpoint, SystemClock(10.0))
        await other.connect()
        measuring = asyncio.create_task(other.pose("base", 0.0))
        await one.reaches("!CMDEXE:base")
        await one.tracker.point("nest1", 0.0)
        assert one.asked("!MEAS_SINGLE_POINT:A;catseye;nest1") > 1
        await measuring
        await other.close()


async def test_a_measurement_without_end_is_halted_and_never_repeated() -> None:
    async with rig({"point_s": 600.0}, speed=1.0, measure_timeout_s=0.2, timeout_s=1.0) as one:
        with pytest.raises(LinkError, match="MEAS_SINGLE_POINT"):
            await one.tracker.point("nest1", 0.0)
        assert one.asked("!MEAS_SINGLE_POINT:A;catseye;nest1") == 1
        await one.tracker.examine()
        assert one.asked("!HALT") == 1


async def test_a_measurement_that_was_not_sent_is_not_halted() -> None:
    async with rig(has_laser=False, timeout_s=0.3) as one:
        (port,) = one.bench.reach.ports_of("tracker")
        port.muted = True
        # The link is held by a question without an answer.
        asking = asyncio.create_task(one.tracker.examine())
        await one.reaches("?STAT")
        measuring = asyncio.create_task(one.tracker.point("nest1", 0.0))
        await asyncio.sleep(0)
        measuring.cancel()
        await asyncio.wait({measuring})
        port.muted = False
        await asking
        await one.tracker.point("nest1", 0.0)
        assert not one.asked("!HALT")


async def test_a_measurement_cancelled_while_busy_is_not_halted() -> None:
    asked: list[bytes] = []

    async def serve(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        while line := await reader.readline():
            asked.append(line)
            writer.write(b"ERR-201 busy\r\n" if line.startswith(b"!MEAS") else b"ACK-300 READY\r\n")

    async with loopback(serve) as port:
        tracker = T2sa.at(f"tcp://127.0.0.1:{port}", SystemClock(), has_laser=False)
        await tracker.connect()
        measuring = asyncio.create_task(tracker.point("nest1", 0.0))
        await until(lambda: asked[-1].startswith(b"!MEAS"))
        await settled()
        measuring.cancel()
        await asyncio.wait({measuring})
        await tracker.connect()
        await tracker.close()
    assert b"!HALT\r\n" not in asked


async def test_a_working_frame_is_set_at_the_start() -> None:
    async with rig(working_frame="WORLD") as one:
        assert one.asked("!SET_WORKING_FRAME:WORLD") == 1
        stranger = T2sa.at(one.bench.endpoints[0].endpoint, SystemClock(), working_frame="none such")
        with pytest.raises(RefusedError, match=r"none such was refused: ERR-314.*correct working_frame"):
            await stranger.connect()


@asynccontextmanager
async def saying(refused: str, *answers: bytes) -> AsyncIterator[str]:
    """Answer as a T2SA does, but for one command, which gets the given answers, the last one for ever.

    Yields:
        The endpoint.
    """
    left = list(answers)

    async def serve(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        while line := await reader.readline():
            refuses = line.decode().startswith(refused)
            writer.write((left.pop(0) if len(left) > 1 else left[0]) if refuses else b"ACK-300 READY\r\n")

    async with loopback(serve) as port:
        yield f"tcp://127.0.0.1:{port}"


async def test_a_simulation_that_does_not_end_is_refused() -> None:
    async with saying("!SET_SIM", b"ERR-200 no\r\n") as endpoint:
        tracker = T2sa.at(endpoint, SystemClock())
        with pytest.raises(RefusedError, match=r"!SET_SIM:0 was refused: ERR-200 no: correct simulates"):
            await tracker.connect()
        await tracker.close()


@pytest.mark.parametrize("command", ["!SET_SIM", "!SET_WORKING_FRAME"])
async def test_a_busy_spatialanalyzer_is_waited_for_at_the_start(command: str) -> None:
    async with saying(command, b"ERR-201 busy\r\n", b"ACK-300 READY\r\n") as endpoint:
        tracker = T2sa.at(endpoint, SystemClock(100.0), working_frame="WORLD")
        assert (await tracker.connect()).model
        await tracker.close()


async def test_a_spatialanalyzer_that_stays_busy_is_called_so() -> None:
    async with saying("!SET_WORKING_FRAME", b"ERR-201 busy\r\n") as endpoint:
        tracker = T2sa.at(endpoint, SystemClock(100.0), working_frame="WORLD", busy_timeout_s=5.0)
        with pytest.raises(RefusedError, match="ERR-201 busy: end what it does"):
            await tracker.connect()
        await tracker.close()


async def test_another_target_than_the_expected_one_is_no_point() -> None:
    async with rig(search_radius_mm=5.0) as one:
        x, y, z = near(one.bench, "nest1")
        await one.tracker.point("nest1", 0.0, (x, y, z + 4.0))
        with pytest.raises(HiddenTargetError, match=r"nest1 was expected at .* 6\.0 mm away .* another one"):
            await one.tracker.point("nest1", 0.0, (x, y, z + 6.0))


async def test_the_plane_has_a_place_with_its_uncertainty() -> None:
    async with rig(plane_target="nest1", u_mm=0.02) as one:
        found = await one.tracker.locate()
        assert (found.x_mm, found.y_mm) == pytest.approx(near(one.bench, "nest1")[:2], abs=1e-5)
        assert found.u_mm == 0.02
    async with rig() as one:
        with pytest.raises(RefusedError, match="state u_mm"):
            await one.tracker.locate()


async def test_a_link_that_loses_lines_is_healed() -> None:
    async with rig(timeout_s=0.3, measure_timeout_s=0.3) as one:
        (port,) = one.bench.reach.ports_of("tracker")
        port.lossy = Lossy(0.05, 3)
        seen = 0
        for _ in range(30):
            try:
                found = await one.tracker.point("nest1", 0.0)
            except (LinkError, ProtocolError):
                continue
            seen += 1
            assert found.place_mm == pytest.approx(near(one.bench, "nest1"), abs=1e-5)
        assert seen > 5


async def answered(line: bytes) -> None:
    """Connect to what answers every line by the same one."""

    async def serve(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        while await reader.readline():
            writer.write(line)

    async with loopback(serve) as port:
        tracker = T2sa.at(f"tcp://127.0.0.1:{port}", SystemClock(), timeout_s=0.3)
        try:
            await tracker.connect()
            await tracker.point("nest1", 0.0)
        finally:
            await tracker.close()


async def test_something_else_behind_the_port_is_no_tracker() -> None:
    with pytest.raises(WrongDeviceError, match="not T2SA: check host and port"):
        await answered(b"HTTP/1.1 400 Bad Request\r\n")
