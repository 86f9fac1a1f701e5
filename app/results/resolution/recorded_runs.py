"""Tests that this program recorded, from runs of the store to a result."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import chain, groupby
from typing import Any

import numpy as np

from catseye.app.cell.arm import arm_description
from catseye.app.errors import UsageError
from catseye.app.results.origin import now_utc
from catseye.app.results.provenance import Provenance
from catseye.app.results.resolution.actuation import actuation_of
from catseye.app.results.resolution.evaluation import Asked, Series, evaluated
from catseye.app.results.resolution.result import AnyTest, ResolutionResult
from catseye.app.results.runs.run_source import are_simulated, cell_of_run
from catseye.app.store.reader import RunReader
from catseye.app.store.software import SOFTWARE
from catseye.calibration.core.errors import CalibrationError
from catseye.calibration.resolution.moves import Moves, moves_of
from catseye.calibration.resolution.optics import AngularOptics, LinearOptics
from catseye.calibration.resolution.recording import Recording, recording_of
from catseye.calibration.resolution.standstill import standstill
from catseye.procedures.resolution.records import Configuration, Move

_Row = Mapping[str, Any]


def holds_tests(reader: RunReader) -> bool:
    """Return whether a run has recorded tests of motion resolution."""
    return reader.count(Configuration.table) > 0


def result_of_runs(readers: Sequence[RunReader], threshold_percent: float) -> ResolutionResult:
    """Return what the tests of runs come to, in the order in which they were made.

    Args:
        readers: runs on one arm, at least one.
        threshold_percent: largest step error of a step that counts.

    Raises:
        UsageError: a run has recorded no test, or they are of several arms.
        CalibrationError: a recording does not fit its moves; names run and test.
    """
    arms = {arm.name: arm for arm in (arm_description(cell_of_run(one).robot.arm) for one in readers)}
    if len(arms) > 1:
        raise UsageError(
            f"the runs are of several arms: {', '.join(arms)}; evaluate those of each by themselves"
        )
    unverified = [text for one in readers for text in one.unverified]
    ((name, description),) = arms.items()
    return ResolutionResult(
        arm=name,
        actuation=actuation_of(description),
        tests=list(chain.from_iterable(_tests(reader, threshold_percent) for reader in readers)),
        provenance=Provenance(
            runs=[one.path.name for one in readers],
            software=SOFTWARE,
            created=now_utc(),
            simulated=are_simulated(readers),
            unverified=unverified or None,
        ),
    )


def _tests(reader: RunReader, threshold_percent: float) -> Iterator[AnyTest]:
    rows: Sequence[_Row] = reader.rows(Configuration.table)
    if not rows:
        raise UsageError(f"{reader.path.name}: has recorded no test of motion resolution")
    for _, group in groupby(rows, key=_test_of):
        members = list(group)
        asked = _asked(members[0], threshold_percent)
        try:
            yield evaluated(asked, [_series(reader, row) for row in members])
        except CalibrationError as error:
            where = f"{reader.path.name}, {asked.test} test of {asked.joint} at {members[0]['position']}"
            raise type(error)(f"{where}: {error}") from error


def _test_of(row: _Row) -> tuple[object, ...]:
    """Return what the series of one test share: those of a test by ISO 230 differ in the size of their steps."""
    together = row["test"] == "iso"
    return (
        row["test"],
        row["joint"],
        row["position"],
        None if together else (row["step_id"], row["direction"]),
    )


def _asked(row: _Row, threshold_percent: float) -> Asked:
    cartesian = row["test"] == "cartesian"
    return Asked(
        row["test"],
        row["joint"],
        row["position_value"],
        row["position"] if cartesian else None,
        threshold_percent,
    )


def _series(reader: RunReader, row: _Row) -> Series:
    recording, optics = _recording(reader, row)
    rows: list[_Row] = [
        move
        for move in reader.rows(Move.table)
        if (move["step_id"], move["recording"]) == (row["step_id"], row["recording"])
    ]
    still = standstill(recording.clipped(row["standstill_from_s"], row["standstill_until_s"]))
    # A test that goes there and back begins where its preliminary moves have led.
    counted = [move for move in rows if row["test"] in {"decaying", "cartesian"} or move["sequence"] > 0]
    series = Series(recording, _moves(counted, row["unit"]), optics, still)
    torques = [(move["ended_s"], move["torque_nm"]) for move in counted if move["torque_nm"] is not None]
    if not torques:
        return series
    torque_s, torque_nm = np.array(torques, dtype=np.float64).T
    return replace(series, torque_s=torque_s, torque_nm=torque_nm)


def _recording(reader: RunReader, row: _Row) -> tuple[Recording, AngularOptics | LinearOptics]:
    recorded: _Row = next(
        one
        for one in reader.recordings()
        if (one["step_id"], one["name"]) == (row["step_id"], row["recording"])
    )
    chunks = [(chunk.times_s, chunk.values) for chunk in reader.chunks(recorded)]
    time_s = np.concatenate([np.array(times) for times, _ in chunks])
    readings = np.concatenate([np.array(values) for _, values in chunks])
    displacement_mm = recorded["scale"] * readings + recorded["offset_mm"]
    if row["spacing_mm"] is None:
        return recording_of(time_s, displacement_mm, "mm"), LinearOptics()
    optics = AngularOptics(row["spacing_mm"], row["u_spacing_mm"] or 0.0, 1e-3 * row["distance_mm"])
    return recording_of(time_s, optics.angle_rad(displacement_mm), "rad"), optics


def _moves(rows: Sequence[_Row], unit: str) -> Moves:
    time_s = np.array([row["time_s"] for row in rows], dtype=np.float64)
    command = np.array([row["command"] for row in rows], dtype=np.float64)
    return moves_of(time_s, np.radians(command), "rad") if unit == "deg" else moves_of(time_s, command, "mm")
