"""Series of stored runs: times of a stream, correction for the air, files that are evaluated again."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.app.results.resolution.recorded_series import sent_times, series_of_run
from catseye.app.results.resolution.series_files import series_files
from catseye.app.store.reader import RunReader
from catseye.procedures.resolution.resolution import Resolution
from tests.unit.procedures.resolution.benches import SIX
from tests.unit.procedures.resolution.test_runs import SHORT, Room, carried_out


@given(
    interval_s=st.floats(1e-3, 0.05),
    start_s=st.floats(0.0, 10.0),
    bunch=st.integers(1, 20),
    seed=st.integers(0, 2**32 - 1),
)
def test_a_stream_in_bunches_gets_its_own_times(
    interval_s: float, start_s: float, bunch: int, seed: int
) -> None:
    sent_s = start_s + interval_s * np.arange(4000)
    # A bunch arrives with its last value, up to a third of an interval later.
    last = np.minimum((np.arange(4000) // bunch + 1) * bunch, 4000) - 1
    late_s = np.random.default_rng(seed).uniform(0.0, interval_s / 3.0, 4000)[last]
    found_s = sent_times(sent_s[last] + late_s)
    steps_s = np.diff(found_s)
    assert steps_s.shape == (3999,)
    assert np.abs(steps_s - interval_s).max() <= 1e-3 * interval_s
    assert np.abs(found_s - sent_s).max() < interval_s


def test_a_short_stream_gets_its_own_times_despite_late_values() -> None:
    sent_s = 0.04 * np.arange(300)
    # Nine values of ten are late by up to half an interval.
    rng = np.random.default_rng(3)
    late_s = rng.uniform(0.0, 0.02, 300) * (rng.random(300) < 0.9)
    found_s = sent_times(sent_s + late_s)
    assert np.diff(found_s) == pytest.approx(np.full(299, 0.04), rel=1e-2)


@pytest.mark.parametrize("lost", [60, 150, 250])
def test_a_value_lost_from_a_short_stream_is_noticed(lost: int) -> None:
    arrival_s = np.delete(0.04 * np.arange(301), lost)
    assert sent_times(arrival_s) is arrival_s


def test_a_stream_with_a_gap_keeps_its_arrivals() -> None:
    arrival_s = np.delete(0.001 * np.arange(10_000), slice(5000, 5003))
    assert sent_times(arrival_s) is arrival_s


def test_a_numbered_stream_keeps_its_rate_however_late_it_arrives() -> None:
    sent_s = np.linspace(0.0, 79.96, 2000)
    # A busy machine takes everything at once after half a second of its own, twice.
    arrival_s = sent_s.copy()
    for busy in (slice(300, 500), slice(1200, 1400)):
        arrival_s[busy] = sent_s[busy][-1] + 0.5
    assert sent_times(arrival_s, complete=True) == pytest.approx(sent_s, abs=1e-6)


async def test_a_series_is_what_was_recorded_and_moved(tmp_path_factory: pytest.TempPathFactory) -> None:
    room = Room(tmp_path_factory.mktemp("runs"))
    outcome = await carried_out(room, Resolution(), Resolution().plan(SIX, SHORT))
    up, down = series_of_run(RunReader(outcome.path))
    assert (up.name, down.name) == ("A1-K3-plus", "A1-K3-minus")
    assert up.command() == pytest.approx([0.1 / 1.072267**n for n in range(6)])
    first_s, second_s = up.move_time_s()[:2]
    between = up.displacement_mm[(up.time_s > first_s + 1.0) & (up.time_s < second_s)]
    # Nine tenths of a tenth of a degree on 30 mm.
    assert between == pytest.approx(np.full(between.size, 0.0471239), abs=1e-6)
    torque_nm = up.torque_nm()
    assert torque_nm is not None
    assert torque_nm.tolist() == [40.0] * 6
    read_s = up.torque_time_s()
    assert (read_s >= [move["ended_s"] + 2.0 for move in up.moves]).all()
    assert (read_s[:-1] <= up.move_time_s()[1:]).all()
    earlier = replace(up, moves=tuple({**move, "torque_s": None} for move in up.moves))
    assert earlier.torque_time_s() == pytest.approx([move["ended_s"] + 2.0 for move in up.moves])


async def test_files_of_a_series_are_those_of_the_formats(
    tmp_path_factory: pytest.TempPathFactory,
) -> None:
    room = Room(tmp_path_factory.mktemp("runs"))
    outcome = await carried_out(room, Resolution(), Resolution().plan(SIX, SHORT))
    files = dict(series_files(RunReader(outcome.path)))
    assert list(files)[:3] == [
        "A1-K3-plus-recording.csv",
        "A1-K3-plus-moves.csv",
        "A1-K3-plus-torque.csv",
    ]
    assert files["A1-K3-plus-recording.csv"].startswith("t_s,displacement_mm\n")
    moves = files["A1-K3-minus-moves.csv"].splitlines()
    assert moves[0] == "t_s,command_deg,sequence"
    assert [float(line.split(",")[1]) for line in moves[1:]] == pytest.approx(
        [-0.1 / 1.072267**n for n in range(6)], abs=1e-9
    )
