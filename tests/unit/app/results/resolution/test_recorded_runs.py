"""Tests of motion resolution that a run has stored; what the joint did is known."""

import math
import zlib
from array import array
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from catseye.app.cell.load import load_cell
from catseye.app.cli.report import report
from catseye.app.cli.resolution.resolution import resolution
from catseye.app.errors import MeasurementRejectedError, UsageError
from catseye.app.results.headlines import headline_of_run
from catseye.app.results.readiness.headline import Headline
from catseye.app.results.resolution.evaluation import Asked
from catseye.app.results.resolution.imported import Import, imported_test
from catseye.app.results.resolution.input_files import RecordingFile
from catseye.app.results.resolution.naming import named_positions
from catseye.app.results.resolution.recorded_runs import holds_tests, result_of_runs
from catseye.app.results.resolution.result import read_resolution
from catseye.app.results.resolution.series_files import series_files
from catseye.app.store.chunks import Chunk, pack
from catseye.app.store.reader import RunReader
from catseye.app.store.run_store import RunStore
from catseye.calibration.core.types import Floats
from catseye.calibration.resolution.errors import MovesError
from catseye.calibration.resolution.optics import AngularOptics
from catseye.procedures.kit.recording import Recorded
from catseye.procedures.kit.records import Record, row_of
from catseye.procedures.resolution.records import Configuration, Move
from tests.unit.app.results.resolution.recordings import DWELL_S, STILL_S, angles, decaying_commands
from tests.unit.app.store.fakes import TickingClock

_CELL = Path(__file__).parents[5] / "docs" / "examples" / "kuka.toml"
_RATE_HZ = 50.0
_SPACING_MM = 30.0
_SCALE = 1.0002
"""Of a reading, corrected for the air."""


def _chunk(command: Floats, moved: Floats, *, linear: bool, grows: int = 1) -> tuple[Chunk, Floats]:
    times_s: Floats = STILL_S + DWELL_S * np.arange(command.size, dtype=np.float64)
    t_s = np.arange(0.0, float(times_s[-1]) + DWELL_S + 1.0, 1.0 / _RATE_HZ)
    position = angles(t_s, times_s, moved)
    length_mm = position if linear else _SPACING_MM * np.sin(np.radians(position))
    length_mm = grows * length_mm + np.random.default_rng(2).normal(0.0, 1e-7, t_s.size)
    return Chunk(array("d", t_s.tolist()), array("d", (length_mm / _SCALE).tolist())), times_s


def _rows(
    test: str, command: Floats, moved: Floats, torque: Floats | None = None, **place: Any
) -> tuple[Chunk, list[Record]]:
    """Return readings and rows of one series."""
    linear = test == "cartesian"
    sequence = np.broadcast_to(place.get("sequence", 1), command.size).tolist()
    chunk, times_s = _chunk(command, moved, linear=linear, grows=place.get("grows", 1))
    recorded = Recorded(
        name="series-1", method="streamed", origin_utc="2026-01-02T03:04:05+00:00", origin_clock_s=0.0,
        readings=len(chunk.values), chunks=1, crc32=zlib.crc32(pack(chunk)), duration_s=100.0, rate_hz=_RATE_HZ,
        jitter_s=0.0, longest_gap_s=0.02, late=0, lost=0, beam_lost=0, overspeed=0, values_lost=0, scale=_SCALE,
        offset_mm=0.0,
    )  # fmt: skip
    configuration = Configuration(
        recording="series-1", test=test, joint=place.get("joint", "A1"), position=place.get("position", "K3"),
        position_value=None if linear else 0.0, direction=1, unit="mm" if linear else "deg",
        amplitude=place.get("amplitude"), absolute=0, standstill_from_s=0.0, standstill_until_s=STILL_S - 1.0,
        dwell_s=DWELL_S, spacing_mm=None if linear else _SPACING_MM, u_spacing_mm=None, distance_mm=500.0,
        moves=command.size,
    )  # fmt: skip
    moves = [
        Move(
            recording="series-1",
            joint="A1",
            number=row + 1,
            sequence=sequence[row],
            command=float(command[row]),
            time_s=float(times_s[row]),
            ended_s=float(times_s[row]) + 0.4,
            torque_nm=None if torque is None else float(torque[row]),
            torque_s=None if torque is None else float(times_s[row]) + DWELL_S - 0.1,
        )
        for row in range(command.size)
    ]
    return chunk, [recorded, *moves, configuration]


async def _stored(tmp_path: Path, *series: tuple[Chunk, Sequence[Record]], records: bool = True) -> RunReader:
    meta: dict[str, Any] = {"configuration": load_cell(_CELL).cell.model_dump(mode="json"), "simulated": True}
    kinds = (Recorded, Move, Configuration) if records else (Recorded,)
    store = await RunStore.create(
        tmp_path, "resolution", meta, TickingClock(), records=kinds, reserve_bytes=0
    )
    for number, (chunk, rows) in enumerate(series):
        key = (f"series-{number}", 1, "series-1")
        await store.append_chunk(key, 1, chunk)
        await store.append_step(key[0], 1, "A1", {}, [(type(row).table, row_of(row)) for row in rows])
    await store.finish("complete", 0)
    return RunReader(store.path)


async def test_a_run_gives_what_its_joint_did(tmp_path: Path) -> None:
    command = decaying_commands(60)
    reader = await _stored(tmp_path, _rows("decaying", command, 1.02 * command))
    result = result_of_runs([reader], 10.0)
    (test,) = result.tests
    assert (result.arm, test.joint, test.position, test.direction) == ("KR 210 R2700", "A1", 0.0, 1)
    assert [move.error_percent for move in test.moves] == pytest.approx([2.0] * 60, abs=0.2)
    assert result.provenance is not None
    assert result.provenance.simulated
    assert result.provenance.runs == [reader.path.name]
    (measured,) = result.measured
    assert measured.run == reader.path.name
    assert measured.optics[0].startswith("angular, spacing ")


async def test_a_runs_figure_counts_its_tests_without_evaluating(tmp_path: Path) -> None:
    command = decaying_commands(60)
    rows = [_rows("decaying", command, command), _rows("decaying", command, command, joint="A2")]
    reader = await _stored(tmp_path, *rows)
    assert headline_of_run(reader.path) == Headline("2 tests recorded")


async def test_each_evaluated_test_is_told(tmp_path: Path) -> None:
    command = decaying_commands(60)
    reader = await _stored(
        tmp_path, _rows("decaying", command, command), _rows("decaying", command, command, joint="A2")
    )
    told: list[tuple[int, int]] = []
    result_of_runs([reader], 10.0, lambda done, of: told.append((done, of)))
    assert told == [(1, 2), (2, 2)]


async def test_sizes_of_one_iso_test_belong_together(tmp_path: Path) -> None:
    signs = np.repeat([1.0, -1.0, 1.0], 10)
    small, large = 0.001 * signs, 0.01 * signs
    reader = await _stored(
        tmp_path,
        _rows("iso", small, 0.0 * small, amplitude=0.001),
        _rows("iso", large, large, amplitude=0.01),
    )
    (test,) = result_of_runs([reader], 10.0).tests
    assert test.amplitudes is not None
    assert [one.distinguishable for one in test.amplitudes] == [False, True]
    assert [one.command for one in test.amplitudes] == pytest.approx([0.001, 0.01])


async def test_torques_of_the_moves_judge_a_reversal(tmp_path: Path) -> None:
    command = np.tile(np.repeat([0.1, -0.1], 10), 5)
    torque = np.where(command > 0.0, 20.0, -10.0) + np.random.default_rng(4).normal(0.0, 0.2, command.size)
    reader = await _stored(tmp_path, _rows("backlash", command, command, torque))
    (test,) = result_of_runs([reader], 10.0).tests
    assert test.reversal is not None
    assert test.reversal.value == pytest.approx(0.0, abs=1e-5)
    assert test.reversal.valid is True


async def test_the_files_of_a_run_give_the_same_result(tmp_path: Path) -> None:
    command = np.concatenate([np.full(5, -0.1), np.tile(np.repeat([0.1, -0.1], 10), 5)])
    moved = command.copy()
    moved[5::10] -= np.sign(command[5::10]) * 0.004
    torque = np.where(command > 0.0, 20.0, -10.0) + np.random.default_rng(4).normal(0.0, 0.2, command.size)
    sequence = np.concatenate([np.zeros(5), 1.0 + np.arange(100) // 10]).astype(np.int64)
    reader = await _stored(tmp_path, _rows("backlash", command, moved, torque, sequence=sequence))
    (expected,) = result_of_runs([reader], 10.0).tests
    files = {ending.rpartition("-")[2]: tmp_path / ending for ending, _ in series_files(reader)}
    for ending, text in series_files(reader):
        (tmp_path / ending).write_text(text, "utf-8")
    found = imported_test(
        Import(
            RecordingFile(
                files["recording.csv"],
                # A run takes its optics as parallel where a series begins, to a degree.
                optics=AngularOptics(_SPACING_MM, 0.0, 0.5, u_zero_rad=math.radians(1.0)),
                zero_is_stated=True,
            ),
            Asked("backlash", "A1", 0.0),
            files["moves.csv"],
            files["torque.csv"],
        )
    )
    assert found.flags == expected.flags
    assert found.reversal is not None
    assert expected.reversal is not None
    assert found.reversal.value == pytest.approx(expected.reversal.value, rel=1e-6)
    assert found.reversal.u == pytest.approx(expected.reversal.u, rel=0.01)
    assert found.reversal.valid is expected.reversal.valid is True
    u_found, u_expected = ([move.u for move in one.moves] for one in (found, expected))
    assert u_found == pytest.approx(u_expected, rel=0.05)


async def test_a_cartesian_test_is_in_mm_at_its_pose(tmp_path: Path) -> None:
    command = 10.0 * decaying_commands(40)
    reader = await _stored(tmp_path, _rows("cartesian", command, command, joint="X", position="P1"))
    (test,) = result_of_runs([reader], 10.0).tests
    assert (test.unit, test.joint, test.pose, test.position) == ("mm", "X", "P1", None)
    assert test.moves[0].measured == pytest.approx(1.0, rel=1e-3)


async def test_a_faulty_series_is_named_with_its_run(tmp_path: Path) -> None:
    command = decaying_commands(30)
    reader = await _stored(tmp_path, _rows("decaying", command, 0.1 * command))
    with pytest.raises(
        MovesError, match=f"{reader.path.name}, decaying test of A1 at K3, direction .1: the 10 largest moves"
    ):
        result_of_runs([reader], 10.0)


@pytest.mark.parametrize("test", ["decaying", "cartesian"])
async def test_optics_may_be_mounted_either_way_round(tmp_path: Path, test: str) -> None:
    command = decaying_commands(60, direction=-1)
    reader = await _stored(
        tmp_path, _rows(test, command, 1.02 * command, joint="X" if test == "cartesian" else "A1", grows=-1)
    )
    (found,) = result_of_runs([reader], 10.0).tests
    assert [move.error_percent for move in found.moves] == pytest.approx([2.0] * 60, abs=0.2)
    assert any("the other way round" in text for text in found.flags)


async def test_lost_motion_stays_positive_however_optics_are_mounted(tmp_path: Path) -> None:
    command = np.tile(np.repeat([0.1, -0.1], 10), 5)
    moved = command.copy()
    moved[10::10] -= np.sign(command[10::10]) * 0.004
    reader = await _stored(tmp_path, _rows("backlash", command, moved, grows=-1))
    (found,) = result_of_runs([reader], 10.0).tests
    assert found.reversal is not None
    assert found.reversal.value == pytest.approx(0.004, abs=1e-4)


async def test_large_steps_show_how_optics_stand_for_small_ones(tmp_path: Path) -> None:
    signs = np.repeat([1.0, -1.0, 1.0], 10)
    small, large = 1e-5 * signs, 0.01 * signs
    reader = await _stored(
        tmp_path,
        _rows("iso", small, 0.0 * small, amplitude=1e-5, grows=-1),
        _rows("iso", large, large, amplitude=0.01, grows=-1),
    )
    (found,) = result_of_runs([reader], 10.0).tests
    assert found.amplitudes is not None
    assert [one.distinguishable for one in found.amplitudes] == [False, True]


async def test_a_position_keeps_the_name_of_its_run(tmp_path: Path) -> None:
    command = decaying_commands(40)
    reader = await _stored(tmp_path, _rows("decaying", command, command))
    tests = result_of_runs([reader], 10.0).tests
    assert named_positions(tests, "A1") == [("K3 = 0°", 0.0)]
    unnamed = tests[0].model_copy(update={"position": -20.0, "position_name": None})
    assert named_positions([*tests, unnamed], "A1") == [("−20°", -20.0), ("K3 = 0°", 0.0)]
    lower = unnamed.model_copy(update={"position": -40.0})
    assert named_positions([*tests, unnamed, lower], "A1")[0] == ("K1 = −40°", -40.0)


async def test_a_run_without_tests_is_refused(tmp_path: Path) -> None:
    reader = await _stored(tmp_path, records=False)
    assert not holds_tests(reader)
    with pytest.raises(UsageError, match="has recorded no test of motion resolution"):
        result_of_runs([reader], 10.0)


async def test_a_faulty_series_leaves_the_others_usable(tmp_path: Path) -> None:
    command = decaying_commands(40)
    reader = await _stored(
        tmp_path,
        _rows("decaying", command, 0.1 * command),
        _rows("decaying", command, command, joint="A2"),
    )
    output = tmp_path / "result.json"
    with pytest.raises(MeasurementRejectedError, match="1 of 2 tests cannot be evaluated"):
        resolution(output, [str(reader.path)], threshold=10.0)
    found = read_resolution(output)
    assert [test.joint for test in found.tests] == ["A2"]
    (refused,) = found.refused
    assert "decaying test of A1 at K3, direction +1: the 10 largest moves" in refused


async def test_commands_take_a_run_by_its_path(tmp_path: Path) -> None:
    command = decaying_commands(40)
    reader = await _stored(tmp_path, _rows("decaying", command, command))
    output, page = tmp_path / "result.json", tmp_path / "page.html"
    resolution(output, [str(reader.path)], threshold=10.0)
    report([str(reader.path)], page)
    assert len(read_resolution(output).tests) == 1
    assert "resolution on KR 210 R2700" in page.read_text("utf-8")
