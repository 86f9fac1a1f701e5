"""The ballbar of the bench: what it reads, and when its magnets let go."""

from dataclasses import replace

import numpy as np
import pytest

from catseye.procedures.serial_arm.plateaus import plateaus
from catseye.simulators.errors import BenchError
from catseye.simulators.survey import Place
from catseye.simulators.world.serial.bench import SerialBench
from tests.unit.simulators.world.serial.surveyed import EXACT, FORWARD, exact_but, surveyed


def centre_for(bench: SerialBench, length_mm: float = 300.0) -> Place:
    """Return a place below nest1, at a distance from it."""
    x, y, z = bench.room.places_mm(["nest1"], np.array([bench.time_s]))[0, 0].tolist()
    return x, y, z - length_mm


def mounted(bench: SerialBench, length_mm: float = 300.0) -> SerialBench:
    """Hang the ballbar in, hands being exact for once."""
    bench.room.set_up_cup(centre_for(bench, length_mm))
    bench.room.nests["centre"].place_mm = np.array(centre_for(bench, length_mm))
    bench.ballbar.mount("nest1")
    return bench


@pytest.mark.parametrize("off_mm", [-0.9, 0.0, 0.4, 0.99])
def test_it_reads_the_distance_from_cup_to_nest(off_mm: float) -> None:
    bench = mounted(surveyed(), 300.0 + off_mm)
    assert bench.ballbar.reading_mm() == pytest.approx(off_mm, abs=1e-9)


def test_beyond_its_range_it_reads_nothing() -> None:
    assert mounted(surveyed(), 301.2).ballbar.reading_mm() is None


def test_it_does_not_reach_much_farther() -> None:
    with pytest.raises(
        BenchError, match=r"nest1 is 302\.0 mm from the cup: the ballbar reaches 300 ± 1\.5 mm"
    ):
        mounted(surveyed(), 302.0)


def test_pulled_too_far_it_falls_off_and_stays_off() -> None:
    bench = mounted(surveyed())
    for joints in ((0.0, 15.0, *FORWARD[2:]), FORWARD):
        bench.move_to(joints, 10.0)
        bench.advance(20.0)
    assert bench.ballbar.reading_mm() is None
    assert bench.ballbar.mounted is None
    bench.ballbar.mount("nest1")
    assert bench.ballbar.reading_mm() == pytest.approx(0.0, abs=1e-9)


def test_it_turns_about_its_cup_without_being_longer() -> None:
    bench = mounted(surveyed())
    bench.room.nests["centre"].place_mm = bench.room.places_mm(["nest1"], np.zeros(1))[0, 0] * [0.0, 0.0, 1.0]
    apart = float(np.hypot(*bench.room.places_mm(["nest1"], np.zeros(1))[0, 0, :2]))
    bench.room.nests["centre"].place_mm[2] -= np.sqrt(300.0**2 - apart**2) if apart < 300.0 else 0.0
    before = bench.room.places_mm(["nest1", "centre"], np.zeros(1))[:, 0]
    bench.move_to((40.0, *FORWARD[1:]), 10.0)
    bench.advance(30.0)
    after = bench.room.places_mm(["nest1", "centre"], np.array([30.0]))[:, 0]
    lengths = [np.linalg.norm(ends[0] - ends[1]) for ends in (before, after)]
    assert lengths[0] == pytest.approx(lengths[1], abs=1e-6)


def test_its_balls_take_the_places_of_retroreflectors() -> None:
    bench = mounted(surveyed())
    names = ("nest1", "nest2", "centre")
    assert [bench.room.nests[name].occupied for name in names] == [False, True, False]
    bench.ballbar.take_off()
    assert [bench.room.nests[name].occupied for name in names] == [True, True, True]


def test_without_a_cup_it_hangs_nowhere() -> None:
    with pytest.raises(BenchError, match="no nest 'centre'"):
        surveyed().ballbar.mount("nest1")


def test_the_cup_stands_about_where_the_cell_says() -> None:
    cup = (500.0, 100.0, 200.0)
    off = [
        np.subtract(surveyed(replace(EXACT, cup=cup), seed).room.nests["centre"].place_mm, cup)
        for seed in range(30)
    ]
    # 90 draws know a standard deviation to 7 %.
    assert np.std(off) == pytest.approx(EXACT.u_cup_mm, rel=0.3)


def test_a_cup_that_stands_there_is_left_alone() -> None:
    room = surveyed().room
    room.set_up_cup((500.0, 100.0, 200.0))
    first = room.nests["centre"].place_mm.copy()
    room.set_up_cup((500.0, 100.0, 200.0))
    np.testing.assert_array_equal(room.nests["centre"].place_mm, first)
    room.set_up_cup((500.0, 100.0, 250.0))
    assert room.nests["centre"].place_mm[2] - first[2] == pytest.approx(50.0, abs=2.0)


def test_it_hangs_on_the_tool_only() -> None:
    with pytest.raises(BenchError, match="world1 is not on the tool"):
        surveyed().ballbar.mount("world1")


def test_readings_scatter_by_half_a_micrometre() -> None:
    bench = mounted(surveyed(exact_but(ballbar_um=0.5)))
    readings = [bench.ballbar.reading_mm() or 0.0 for _ in range(200)]
    assert 4e-4 < np.std(readings) < 6e-4


def test_its_recording_holds_what_is_read_at_each_place() -> None:
    bench = mounted(surveyed(exact_but(ballbar_um=0.5)))
    typed = []
    for by_deg in (0.0, 0.03, -0.03, 0.06):
        joints = (FORWARD[0], FORWARD[1] + by_deg, *FORWARD[2:])
        bench.move_to(joints, 1.0)
        bench.advance(bench.room.standstill_s - bench.time_s + 2.5)
        typed.append(bench.ballbar.reading_mm() or np.nan)
    bench.ballbar.take_off()
    times_s, deviations_mm = bench.ballbar.recording()
    assert np.diff(times_s) == pytest.approx(0.05)
    # Noise of 0.5 µm.
    found = plateaus(times_s, deviations_mm, 1.0, 0.005)
    assert found == pytest.approx(typed, abs=0.003)


def test_its_recording_ends_where_it_falls_off() -> None:
    bench = mounted(surveyed())
    bench.move_to((0.0, 15.0, *FORWARD[2:]), 10.0)
    bench.advance(20.0)
    times_s, deviations_mm = bench.ballbar.recording()
    assert times_s[-1] < 10.0
    assert np.abs(deviations_mm).max() <= 1.0
