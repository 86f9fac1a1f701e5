"""A tracker knows places as well as its encoders and its distance meter are, whichever question it is asked."""

import struct
from collections.abc import Callable

import numpy as np
import pytest

from catseye.simulators.emulated_bench import EmulatedSerialBench
from catseye.simulators.survey import SurveyConfig
from catseye.simulators.world.types import Floats
from tests.unit.simulators.trackers import Client, near, tracker_bench
from tests.unit.simulators.world.serial.surveyed import TARGETS

SURVEY = SurveyConfig(targets=TARGETS, u_target_mm=0.0)
REPEATS = 30
PROTOCOLS = ("leica-emscon", "t2sa")


def command(number: int, layout: str = "", *values: float) -> bytes:
    data = struct.pack(f"<{layout}", *values)
    return struct.pack("<iii", 12 + len(data), 0, number) + data


class Leica:
    """A client whose tracker is locked on nest1; lengths in mm, angles in rad, Cartesian."""

    def __init__(self) -> None:
        self.bench: EmulatedSerialBench = tracker_bench(
            "leica-emscon", survey=SURVEY, options={"initialised": True}
        )
        self.client = Client(self.bench)
        self.ask(command(5, "5i", 1, 0, 0, 0, 0))
        self.ask(command(26, "i", 0))
        self.settings(reflector_positions=False)

    def ask(self, data: bytes, wait_s: float = 0.0) -> bytes:
        return self.client.say(data) + (self.client.wait(wait_s) if wait_s else b"")

    def settings(self, *, reflector_positions: bool) -> None:
        """Have the weather monitor calculate, and no news but these sent."""
        self.ask(command(47, "9i", 2, 0, 0, 1, 0, reflector_positions, 0, 1, 0))

    def lock(self) -> "Leica":
        place = near(self.bench, "nest1")
        (status,) = struct.unpack_from("<i", self.ask(command(55, "3di", *place, 1), 1.0), 12)
        assert status == 0
        self.client.wait(1.0)
        return self

    @property
    def true_mm(self) -> Floats:
        return np.array(near(self.bench, "nest1"))

    def prism(self) -> Floats:
        return np.array(struct.unpack_from("<3d", self.ask(command(124)), 16))

    def direction_mm(self) -> Floats:
        """Return where the stated direction leads at the true distance."""
        turn, zenith = struct.unpack_from("<2d", self.ask(command(66)), 16)
        level = np.sin(zenith)
        way = np.array([level * np.cos(turn), level * np.sin(turn), np.cos(zenith)])
        return np.asarray(np.linalg.norm(self.true_mm) * way)

    def looked_for_mm(self) -> Floats:
        """Return the same of the answer to a search."""
        place = near(self.bench, "nest1")
        turn, zenith = struct.unpack_from("<2d", self.ask(command(65, "4d", *place, 50.0), 1.0), 16)
        level = np.sin(zenith)
        way = np.array([level * np.cos(turn), level * np.sin(turn), np.cos(zenith)])
        return np.asarray(np.linalg.norm(self.true_mm) * way)

    def streamed(self) -> Floats:
        """Return the place of the reflector that the server sends unasked."""
        self.settings(reflector_positions=True)
        said = self.client.wait(0.7)
        while struct.unpack_from("<2i", said) != (36, 7):
            said = said[struct.unpack_from("<i", said)[0] :]
        return np.array(struct.unpack_from("<3d", said, 12))

    def measured(self) -> Floats:
        """Return a stationary measurement of half a second."""
        self.ask(command(28, "2i", 500, 0))
        said = self.ask(command(49), 0.6)
        while struct.unpack_from("<2i", said) != (156, 2):
            said = said[struct.unpack_from("<i", said)[0] :]
        return np.array(struct.unpack_from("<3d", said, 20))


def across_um(range_mm: float) -> float:
    return SURVEY.angle_um + SURVEY.angle_um_per_m * 1e-3 * range_mm


ASK: dict[str, Callable[[Leica], Floats]] = {
    "current prism position": Leica.prism,
    "direction": Leica.direction_mm,
    "look for target": Leica.looked_for_mm,
    "reflector position": Leica.streamed,
    "measurement": Leica.measured,
}


@pytest.mark.parametrize("question", ASK)
def test_no_answer_about_a_target_is_its_true_place(question: str) -> None:
    leica = Leica().lock()
    off_mm = np.array([ASK[question](leica) - leica.true_mm for _ in range(REPEATS)])
    u_mm = 1e-3 * across_um(float(np.linalg.norm(leica.true_mm)))
    # Of each half a second or less, half of the noise does not average out.
    assert float(np.sqrt((off_mm**2).mean())) > 0.4 * u_mm
    assert float(off_mm.std(axis=0).max()) > 0.4 * u_mm
    assert np.linalg.norm(off_mm, axis=1).max() < 1.0


def test_a_place_in_the_home_position_is_measured() -> None:
    leica = Leica()
    places = np.array([leica.measured() for _ in range(REPEATS)])
    spread_mm = places.std(axis=0, ddof=1)
    u_mm = 1e-3 * across_um(161.0)
    assert spread_mm.min() > 0.2e-3 * SURVEY.range_um
    assert 0.4 * u_mm < spread_mm.max() < 5.0 * u_mm


def test_a_lost_beam_does_not_show_its_targets_place() -> None:
    leica = Leica().lock()
    leica.bench.bench.tracker.block(None)
    off_mm = np.array([leica.direction_mm() - leica.true_mm for _ in range(REPEATS)])
    assert float(off_mm.std(axis=0).max()) > 0.4e-3 * across_um(float(np.linalg.norm(leica.true_mm)))


def test_a_continuous_measurement_scatters_more_than_a_long_one() -> None:
    leica = Leica().lock()
    leica.ask(command(24, "i", 1))
    leica.ask(command(30, "4i", 20, REPEATS, 0, 0))
    said = leica.ask(command(49), 2.0)
    points: list[tuple[float, ...]] = []
    while said:
        size, kind = struct.unpack_from("<2i", said)
        if kind == 3:
            (count,) = struct.unpack_from("<i", said, 12)
            points += [struct.unpack_from("<3d", said, 48 + 36 * n + 12) for n in range(count)]
        said = said[size:]
    assert len(points) == REPEATS
    errors = (np.array(points) - leica.true_mm).T
    u_mm = 1e-3 * across_um(float(np.linalg.norm(leica.true_mm)))
    assert float(errors.std(axis=1, ddof=1).max()) > u_mm


def test_points_of_spatial_analyzer_scatter_and_so_do_its_frames() -> None:
    bench = tracker_bench("t2sa", survey=SURVEY)
    client = Client(bench)
    off_mm, poses = [], []
    for _ in range(REPEATS):
        said = (client.say(b"!MEAS_SINGLE_POINT:A;g;nest1\r\n") + client.wait(1.5)).decode()
        point = said.split("result ")[1].split(" ")[0]
        off_mm.append(np.array([float(value) for value in point.split(",")]) - np.array(near(bench, "nest1")))
        client.say(b"!CMDEXE:base\r\n")
        client.wait(2.5)
        report = client.say(b"?POS base\r\n").decode().split(";")[1:7]
        poses.append([float(value.partition(":")[2]) for value in report])
    u_mm = 1e-3 * across_um(float(np.linalg.norm(near(bench, "nest1"))))
    spread_mm = np.array(off_mm).std(axis=0, ddof=1)
    assert 0.4 * u_mm < spread_mm.max() < 2.0 * u_mm
    marks_um = 1e3 * np.array(poses).std(axis=0, ddof=1)[:3]
    assert marks_um.max() > 0.1 * SURVEY.mark_um
