"""The driver in front of the emulated emScon server, over real loopback sockets."""

import asyncio
import struct
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from catseye.drivers.leica.tracker import LeicaEmscon
from catseye.drivers.roles.clock import SystemClock
from catseye.drivers.roles.errors import (
    HiddenTargetError,
    LinkError,
    RefusedError,
    WrongDeviceError,
)
from catseye.drivers.roles.tracker import Place, TargetPoint
from catseye.simulators.config import Joints, Option
from catseye.simulators.emulated_bench import EmulatedSerialBench
from catseye.simulators.leica import packets
from catseye.simulators.leica.server import BUSY, Said, Server
from catseye.simulators.ports.lossy import Lossy
from catseye.simulators.survey import SurveyConfig
from tests.unit.drivers.peers import loopback
from tests.unit.simulators.trackers import near, tracker_bench
from tests.unit.simulators.world.serial.surveyed import EXACT, FORWARD, exact_but

SPEED = 50.0
AWAY: Joints = (0.0, 10.0, -10.0, 0.0, 60.0, 0.0)
"""The tool looks at the floor."""


@dataclass
class Rig:
    """A driver and the bench behind it."""

    bench: EmulatedSerialBench
    tracker: LeicaEmscon

    async def point(self, name: str, dwell_s: float = 0.2, face: int = 1) -> TargetPoint:
        """Measure a nest where it is."""
        return await self.tracker.point(name, dwell_s, near(self.bench, name), 1 if face == 1 else 2)

    def asked(self, number: int) -> int:
        """Return how often a command came."""
        entries = self.bench.journal.entries("tracker")
        return sum(entry.text.startswith(f"command {number},") for entry in entries)

    async def reaches(self, number: int) -> None:
        """Wait until a command has come once more."""
        before = self.asked(number)
        while self.asked(number) == before:  # noqa: ASYNC110  # the emulator tells nobody
            await asyncio.sleep(0.001)


@asynccontextmanager
async def rig(
    options: dict[str, Option] | None = None,
    survey: SurveyConfig = EXACT,
    start: Joints = FORWARD,
    speed: float = SPEED,
    **settings: Any,
) -> AsyncIterator[Rig]:
    async with tracker_bench(
        "leica-emscon",
        options={"initialised": True, **(options or {})},
        survey=survey,
        start=start,
        speed=speed,
    ) as bench:
        # An instrument without noise states no uncertainty.
        tracker = LeicaEmscon.at(
            bench.endpoints[0].endpoint, SystemClock(speed), **{"u_mm": 0.01, **settings}
        )
        try:
            await tracker.connect()
            yield Rig(bench, tracker)
        finally:
            await tracker.close()


@asynccontextmanager
async def other_client(one: Rig) -> AsyncIterator[asyncio.StreamWriter]:
    """Connect as another program."""
    port = int(one.bench.endpoints[0].endpoint.rpartition(":")[2])
    reader, writer = await asyncio.open_connection("127.0.0.1", port)

    async def read() -> None:
        while await reader.read(4096):
            pass

    reading = asyncio.create_task(read())
    try:
        yield writer
    finally:
        writer.close()
        await asyncio.wait({reading})


def command(number: int, layout: str = "", *values: float) -> bytes:
    data = struct.pack(f"<{layout}", *values)
    return struct.pack("<iii", 12 + len(data), 0, number) + data


async def test_the_server_is_recognised_and_set_up() -> None:
    async with rig() as one:
        identity = await one.tracker.connect()
        assert identity.simulated
        assert identity.model.startswith("Leica AT901")
        assert identity.serial
        kept = one.bench.context
        assert kept.serial_bench.tracker.face == 1


async def test_points_are_where_the_nests_are() -> None:
    async with rig() as one:
        for name in ("nest1", "nest2", "nest3", "world1"):
            found = await one.point(name)
            np.testing.assert_allclose(found.place_mm, near(one.bench, name), atol=2e-3)


async def test_uncertainties_are_those_of_the_instrument() -> None:
    async with rig(survey=exact_but(range_um=8.0, angle_um=12.0)) as one:
        found = await one.point("nest1", 1.0)
        assert found.u_mm is not None
        assert all(0.005 < u < 0.03 for u in found.u_mm)


async def test_covariances_have_the_beam_as_an_axis() -> None:
    async with rig(survey=exact_but(range_um=2.0, angle_um=20.0)) as one:
        found = await one.point("nest1", 1.0)
        assert found.u_mm is not None
        assert found.covariance_mm2 is not None
        xy, xz, yz = found.covariance_mm2
        known = np.array([[0.0, xy, xz], [xy, 0.0, yz], [xz, yz, 0.0]]) + np.diag(np.square(found.u_mm))
        along = np.array(found.place_mm) / np.linalg.norm(found.place_mm)
        variances, axes = np.linalg.eigh(known)
        # 2 um along the beam, 20 um across it, in both directions.
        assert abs(axes[:, 0] @ along) == pytest.approx(1.0, abs=1e-4)
        assert np.sqrt(variances[1:] / variances[0]) == pytest.approx([10.0, 10.0], rel=1e-3)


async def test_a_tracker_is_initialised_before_the_first_point() -> None:
    async with rig({"initialised": False}) as one:
        assert one.asked(7) == 0
        await one.point("nest1")
        await one.point("nest1")
        assert one.asked(7) == 1


async def test_the_home_position_is_not_taken_for_a_target() -> None:
    async with rig({"initialised": False}) as one:
        with pytest.raises(HiddenTargetError, match="home position"):
            await one.tracker.point("nest1", 0.2)
        assert not one.asked(49)


@pytest.mark.parametrize("number", [10, 54], ids=["parked", "bird bath"])
async def test_a_tracker_sent_home_by_another_sees_no_target(number: int) -> None:
    async with rig() as one, other_client(one) as writer:
        await one.point("nest1")
        writer.write(command(number))
        while not one.bench.bench.tracker.parked:
            await asyncio.sleep(0)
            one.bench.keeper.sync()
        with pytest.raises(HiddenTargetError, match="home position"):
            await one.tracker.point("nest1", 0.2)


async def test_both_faces_are_measured() -> None:
    async with rig(survey=exact_but(face_urad=100.0)) as one:
        places = [np.array((await one.point("nest1", face=face)).place_mm) for face in (1, 2)]
        assert one.asked(53) == 1
        assert np.linalg.norm(places[0] - places[1]) > 0.02
        np.testing.assert_allclose(0.5 * (places[0] + places[1]), near(one.bench, "nest1"), atol=3e-3)


async def test_a_target_that_looks_away_is_hidden() -> None:
    async with rig(start=AWAY) as one:
        with pytest.raises(HiddenTargetError, match="nest1 is not seen"):
            await one.point("nest1")
        await one.point("world1")


async def test_a_target_without_a_place_is_searched_around_the_beam() -> None:
    async with rig() as one:
        await one.point("nest1")
        assert (await one.tracker.point("nest1", 0.2)).place_mm == pytest.approx(
            near(one.bench, "nest1"), abs=2e-3
        )
        with pytest.raises(HiddenTargetError):
            await one.tracker.point("other", 0.2, (300.0, 300.0, 900.0))
        with pytest.raises(HiddenTargetError):
            await one.tracker.point("other", 0.2)


async def test_the_plane_has_the_target_in_the_beam() -> None:
    async with rig() as one:
        await one.point("nest1")
        found = await one.tracker.locate()
        assert (found.x_mm, found.y_mm) == pytest.approx(near(one.bench, "nest1")[:2], abs=2e-3)


async def test_another_target_than_the_expected_one_is_no_point() -> None:
    async with rig(search_radius_mm=5.0) as one:
        x, y, z = near(one.bench, "nest1")
        with pytest.raises(HiddenTargetError, match=r"expected at .* and a target 1\d\.\d mm"):
            await one.tracker.point("nest1", 0.2, (x, y, z + 15.0))


async def test_a_beam_that_breaks_once_is_led_back() -> None:
    async with rig(speed=5.0) as one:
        await one.point("nest1")
        measuring = asyncio.create_task(one.point("nest1", 2.0))
        await one.reaches(49)
        one.bench.keeper.sync()
        one.bench.bench.tracker.block(0.1)
        found = await measuring
        assert found.place_mm == pytest.approx(near(one.bench, "nest1"), abs=2e-3)
        assert one.asked(49) == 3


async def test_something_in_the_beam_hides_the_target() -> None:
    async with rig() as one:
        one.bench.bench.tracker.block(None)
        with pytest.raises(HiddenTargetError):
            await one.point("nest1")
        one.bench.bench.clear_faults()
        await one.point("nest1")


async def test_a_cancelled_measurement_leaves_no_result_behind() -> None:
    async with rig(speed=5.0) as one:
        measuring = asyncio.create_task(one.point("nest1", 5.0))
        await one.reaches(49)
        measuring.cancel()
        await asyncio.wait({measuring})
        found = await one.point("world1", 0.2)
        assert found.place_mm == pytest.approx(near(one.bench, "world1"), abs=2e-3)
        assert one.asked(52) == 1


async def test_an_unanswered_measurement_is_stopped_and_never_repeated() -> None:
    async with rig(speed=1.0, timeout_s=0.3, measure_timeout_s=0.3) as one:
        await one.point("nest1")
        started = one.asked(49)
        measuring = asyncio.create_task(one.tracker.point("nest1", 0.3))
        await one.reaches(49)
        one.bench.keeper.speed = 0.05
        with pytest.raises(LinkError):
            await measuring
        assert one.asked(49) == started + 1
        one.bench.keeper.speed = SPEED
        await one.point("nest1")
        assert one.asked(52) >= 1


async def test_news_that_nobody_asked_for_confuse_nothing() -> None:
    async with rig(speed=5.0) as one, other_client(one) as writer:
        for _ in range(3):
            writer.write(command(47, "9i", 2, 0, 0, 1, 1, 1, 0, 1, 0))
            await writer.drain()
            found = await one.point("nest1")
            assert found.place_mm == pytest.approx(near(one.bench, "nest1"), abs=2e-3)


async def test_units_that_another_program_changed_are_noticed() -> None:
    async with rig() as one, other_client(one) as writer:
        await one.point("nest1")
        writer.write(command(5, "5i", 0, 0, 0, 0, 0))
        await one.reaches(5)
        with pytest.raises(RefusedError, match=r"set of units: .* another program uses it"):
            await one.point("nest1")
        await one.tracker.connect()
        await one.point("nest1")


TRANSFORMATION_ON = command(47, "9i", 2, 1, 0, 1, 0, 0, 0, 1, 0)
ORIENTATION_ON = command(47, "9i", 2, 0, 1, 1, 0, 0, 0, 1, 0)
OTHER_REFLECTOR = command(40, "i", 2)
CHANGES = [
    (47, TRANSFORMATION_ON, "frame"),
    (47, ORIENTATION_ON, "frame"),
    (40, OTHER_REFLECTOR, "reflector"),
]


@pytest.mark.parametrize(("number", "change", "what"), CHANGES)
async def test_a_frame_or_reflector_that_was_changed_is_noticed(
    number: int, change: bytes, what: str
) -> None:
    async with rig() as one, other_client(one) as writer:
        await one.point("nest1")
        writer.write(change)
        await one.reaches(number)
        with pytest.raises(RefusedError, match=f"{what}.* another program uses it"):
            await one.point("nest1")
        await one.tracker.connect()
        await one.point("nest1")


@pytest.mark.parametrize(("number", "change", "what"), CHANGES)
async def test_what_is_changed_during_a_measurement_is_noticed(number: int, change: bytes, what: str) -> None:
    async with rig(speed=5.0) as one, other_client(one) as writer:
        measuring = asyncio.create_task(one.point("nest1", 2.0))
        await one.reaches(49)
        writer.write(change)
        with pytest.raises(RefusedError, match=f"{what}.* another program uses it"):
            await measuring
        assert one.asked(number)


async def test_a_reflector_changed_while_the_link_was_lost_is_noticed() -> None:
    async with rig() as one, other_client(one) as writer:
        await one.point("nest1")
        writer.write(OTHER_REFLECTOR)
        await one.reaches(40)
        for port in one.bench.reach.ports_of("tracker"):
            port.drop()
        with pytest.raises(RefusedError, match="reflector"):
            await one.point("nest1")


async def test_a_face_that_changes_while_aiming_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    async with rig(survey=exact_but(face_urad=100.0)) as one:
        tracker = one.bench.bench.tracker
        aim = tracker.aim

        def aim_over(near_mm: Place | None = None) -> bool:
            found = aim(near_mm)
            monkeypatch.undo()
            tracker.change_face()
            return found

        monkeypatch.setattr(tracker, "aim", aim_over)
        with pytest.raises(RefusedError, match="in face 2 and not in face 1"):
            await one.point("nest1")


async def test_a_busy_tracker_is_waited_for() -> None:
    async with rig(busy_timeout_s=60.0) as one, other_client(one) as writer:
        writer.write(command(7))
        await one.reaches(7)
        point = await one.point("nest1")
        assert point.place_mm == pytest.approx(near(one.bench, "nest1"), abs=1.0)


def busy(monkeypatch: pytest.MonkeyPatch, number: int, times: int) -> None:
    """Have the server put a command off so many times once a measurement has been started."""
    carry_out, left = Server.carry_out, [times]

    def put_off(server: Server, asked: packets.Command) -> Said:
        if asked.number == number and server.instrument.locked and left[0] > 0:
            left[0] -= 1
            return packets.reply(number, BUSY)
        return carry_out(server, asked)

    monkeypatch.setattr(Server, "carry_out", put_off)


@pytest.mark.parametrize(
    "number", [6, 25, 41, 48, 98], ids=["units", "mode", "reflector", "settings", "face"]
)
async def test_a_check_that_is_put_off_is_repeated(number: int, monkeypatch: pytest.MonkeyPatch) -> None:
    async with rig() as one:
        await one.point("nest1")
        busy(monkeypatch, number, 3)
        before = one.asked(number)
        await one.point("nest1")
        # Twice for each point, before and behind it.
        assert one.asked(number) - before == 2 + 3


async def test_a_tracker_that_stays_busy_is_called_so(monkeypatch: pytest.MonkeyPatch) -> None:
    async with rig(busy_timeout_s=1.0) as one:
        await one.point("nest1")
        busy(monkeypatch, 98, 1_000_000)
        with pytest.raises(RefusedError, match="FACE was refused: the tracker is busy"):
            await one.point("nest1")


async def test_a_measurement_that_was_not_begun_is_not_stopped(monkeypatch: pytest.MonkeyPatch) -> None:
    carry_out = Server.carry_out

    def with_another_answer(server: Server, asked: packets.Command) -> Said:
        said = carry_out(server, asked)
        return said + packets.reply(98, 0) if asked.number == 2 and isinstance(said, bytes) else said

    async with rig() as one:
        monkeypatch.setattr(Server, "carry_out", with_another_answer)
        # The link is healed before the measurement is begun.
        await one.point("nest1")
        assert one.asked(49) == 1
        assert not one.asked(52)


async def test_a_cold_laser_is_reported() -> None:
    async with rig({"warm_up_s": 10_000.0}) as one:
        with pytest.raises(RefusedError, match=r"laser heating up.*let it warm up"):
            await one.point("nest1")
        examined = await one.tracker.examine()
        assert any("heating" in text for text in examined.advice)


async def test_the_doctor_hears_of_face_reflector_and_air() -> None:
    async with rig({"has_weather": False}) as one:
        examined = await one.tracker.examine()
        text = " ".join(examined.facts)
        for part in ("laser ready", "face 1", "reflector CCR-1.5in", "19.0500 mm", "°C", "hPa"):
            assert part in text
        assert any("no weather station" in advice for advice in examined.advice)


async def test_the_air_is_set_where_there_is_no_weather_station() -> None:
    air: dict[str, Any] = {"temperature_c": 23.5, "pressure_hpa": 990.0, "humidity_percent": 40.0}
    async with rig({"has_weather": False}, **air) as one:
        examined = await one.tracker.examine()
        assert any("23.50 °C, 990.00 hPa" in fact for fact in examined.facts)
        assert not examined.advice


async def test_a_reflector_is_chosen_by_its_name() -> None:
    async with rig(reflector="CCR-0.5in") as one:
        assert any("CCR-0.5in" in fact for fact in (await one.tracker.examine()).facts)
        stranger = LeicaEmscon.at(one.bench.endpoints[0].endpoint, SystemClock(), reflector="none such")
        with pytest.raises(RefusedError, match=r"knows no reflector 'none such', but 'CCR-1\.5in'"):
            await stranger.connect()


async def test_a_link_that_loses_bytes_is_healed() -> None:
    async with rig(timeout_s=0.2, measure_timeout_s=0.2) as one:
        seen = 0
        (port,) = one.bench.reach.ports_of("tracker")
        port.lossy = Lossy(0.05, 7)
        for _ in range(20):
            try:
                found = await one.point("nest1", 0.05)
            except LinkError:
                continue
            seen += 1
            assert found.place_mm == pytest.approx(near(one.bench, "nest1"), abs=2e-3)
        assert seen > 3


async def test_something_else_behind_the_port_is_no_tracker() -> None:
    async def serve(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        while await reader.read(64):
            writer.write(b"HTTP/1.1 400 Bad Request\r\n\r\n")

    async with loopback(serve) as port:
        tracker = LeicaEmscon.at(f"tcp://127.0.0.1:{port}", SystemClock(), timeout_s=0.3)
        with pytest.raises(WrongDeviceError, match="not an emScon server: check host and port 700"):
            await tracker.connect()
        await tracker.close()


def test_the_air_is_given_whole_or_not_at_all() -> None:
    with pytest.raises(ValueError, match="together, or none of them"):
        LeicaEmscon.at("tcp://127.0.0.1:700", SystemClock(), temperature_c=20.0)
