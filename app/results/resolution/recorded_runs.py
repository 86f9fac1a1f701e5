"""Tests that this program recorded, from runs of the store to a result."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import chain, groupby
from typing import Any, Final, Literal

import numpy as np

from catseye.app.cell.arm import arm_description
from catseye.app.errors import UsageError
from catseye.app.results.origin import now_utc
from catseye.app.results.provenance import Provenance
from catseye.app.results.resolution.actuation import actuation_of
from catseye.app.results.resolution.evaluation import Asked, Series, evaluated
from catseye.app.results.resolution.recorded_series import RecordedSeries, series_of_run
from catseye.app.results.resolution.result import AnyTest, MeasuredRun, ResolutionResult
from catseye.app.results.runs.event_text import device_text
from catseye.app.results.runs.run_source import are_simulated, cell_of_run
from catseye.app.store.reader import RunReader
from catseye.app.store.software import SOFTWARE
from catseye.calibration.core.errors import CalibrationError
from catseye.calibration.resolution.errors import MovesError
from catseye.calibration.resolution.mounting import other_way_round
from catseye.calibration.resolution.moves import moves_of
from catseye.calibration.resolution.optics import U_ZERO_DEG, AngularOptics, LinearOptics
from catseye.calibration.resolution.recording import Recording, recording_of
from catseye.calibration.resolution.standstill import standstill
from catseye.procedures.resolution.records import Configuration

_OTHER_WAY_ROUND: Final = (
    "the count falls while the command grows: the optics were mounted the other way round, and the sign of the "
    "recording was changed"
)


def holds_tests(reader: RunReader) -> bool:
    """Return whether a run has recorded tests of motion resolution."""
    return reader.count(Configuration.table) > 0


def tests_recorded(reader: RunReader) -> int:
    """Return how many tests a run has recorded."""
    return sum(1 for _ in groupby(reader.rows(Configuration.table), key=_test_of))


def result_of_runs(
    readers: Sequence[RunReader],
    threshold_percent: float,
    done: Callable[[int, int], None] | None = None,
) -> ResolutionResult:
    """Return what the tests of runs come to, in the order in which they were made.

    Args:
        readers: runs on one arm, at least one.
        threshold_percent: largest step error of a step that counts.
        done: is called with the number of evaluated tests and of all.

    A test that cannot be evaluated leaves the others what they are: the result says which, and why.

    Raises:
        UsageError: a run has recorded no test, or they are of several arms.
        MovesError: no test can be evaluated; names run and test.
    """
    arms = {arm.name: arm for arm in (arm_description(cell_of_run(one).robot.arm) for one in readers)}
    if len(arms) > 1:
        raise UsageError(
            f"the runs are of several arms: {', '.join(arms)}; evaluate those of each by themselves"
        )
    tests: list[AnyTest] = []
    refused: list[MovesError] = []
    count = sum(tests_recorded(reader) for reader in readers)
    judged = chain.from_iterable(_tests(reader, threshold_percent) for reader in readers)
    for number, test in enumerate(judged, 1):
        if isinstance(test, MovesError):
            refused.append(test)
        else:
            tests.append(test)
        if done is not None:
            done(number, count)
    if not tests:
        raise refused[0]
    unverified = [text for one in readers for text in one.unverified]
    ((name, description),) = arms.items()
    return ResolutionResult(
        arm=name,
        actuation=actuation_of(description),
        tests=tests,
        measured=[_measured(reader) for reader in readers],
        refused=[str(error) for error in refused],
        provenance=Provenance(
            runs=[one.path.name for one in readers],
            software=SOFTWARE,
            created=now_utc(),
            simulated=are_simulated(readers),
            unverified=unverified or None,
        ),
    )


def _measured(reader: RunReader) -> MeasuredRun:
    cell = cell_of_run(reader)
    optics: list[str] = []
    if cell.angular_optics is not None:
        spacing, u = cell.angular_optics.spacing_mm, cell.angular_optics.u_spacing_mm
        optics.append(
            f"angular, spacing {spacing:g} mm, u = {u:g} mm (k = 1); taken as parallel where a series begins, "
            f"u = {U_ZERO_DEG:g}°"
        )
    if cell.linear_optics is not None:
        optics.append("linear")
    devices: Any = reader.meta.get("devices") or {}
    return MeasuredRun(
        run=reader.path.name,
        started_utc=reader.events()[0].time_utc,
        operator=str(reader.meta.get("operator", "")),
        devices=[f"{name} {device_text(facts)}" for name, facts in devices.items()],
        optics=optics,
    )


def _tests(reader: RunReader, threshold_percent: float) -> Iterator[AnyTest | MovesError]:
    recorded = list(series_of_run(reader))
    if not recorded:
        raise UsageError(f"{reader.path.name}: has recorded no test of motion resolution")
    return _judged(recorded, reader.path.name, threshold_percent)


def evaluate_series(
    recorded: Sequence[RecordedSeries], source: str, threshold_percent: float
) -> Iterator[AnyTest]:
    """Yield what series come to, those of one test by ISO 230 together.

    Args:
        source: of the series, for messages.
        threshold_percent: largest step error of a step that counts.

    Raises:
        MovesError: a recording does not fit its moves; names source and test.
    """
    for test in _judged(recorded, source, threshold_percent):
        if isinstance(test, MovesError):
            raise test
        yield test


def _judged(
    recorded: Sequence[RecordedSeries], source: str, threshold_percent: float
) -> Iterator[AnyTest | MovesError]:
    """Yield what each test comes to, or why it cannot be evaluated."""
    for _, group in groupby(recorded, key=lambda one: _test_of(one.configuration)):
        members = list(group)
        asked = _asked(members[0].configuration, threshold_percent)
        try:
            yield _evaluated(asked, members)
        except CalibrationError as error:
            place = members[0].configuration
            way = "" if asked.test in {"iso", "backlash"} else f", direction {place['direction']:+d}"
            yield MovesError(
                f"{source}, {asked.test} test of {asked.joint} at {place['position']}{way}: {error}"
            )


def _evaluated(asked: Asked, members: Sequence[RecordedSeries]) -> AnyTest:
    """Return what the series of one test come to, whichever way round its optics were mounted."""
    series = [_series(one) for one in members]
    if not other_way_round((one.recording, one.moves) for one in series):
        return evaluated(asked, series)
    test = evaluated(asked, [_series(one, sign=-1) for one in members])
    return test.model_copy(update={"flags": [_OTHER_WAY_ROUND, *test.flags]})


def _test_of(row: Mapping[str, Any]) -> tuple[object, ...]:
    """Return what the series of one test share: those of a test by ISO 230 differ in the size of their steps."""
    together = row["test"] == "iso"
    return (
        row["test"],
        row["joint"],
        row["position"],
        None if together else (row["step_id"], row["direction"]),
    )


def _asked(row: Mapping[str, Any], threshold_percent: float) -> Asked:
    pose, position = (row["position"], None) if row["test"] == "cartesian" else (None, row["position"])
    return Asked(row["test"], row["joint"], row["position_value"], pose, threshold_percent, position)


def _series(recorded: RecordedSeries, sign: Literal[1, -1] = 1) -> Series:
    row = recorded.configuration
    recording, optics = _recording(recorded, sign)
    still = standstill(recording.clipped(row["standstill_from_s"], row["standstill_until_s"]))
    # A test that goes there and back begins where its preliminary moves have led.
    there_and_back = row["test"] in {"iso", "backlash"}
    counted = np.array([not there_and_back or move["sequence"] > 0 for move in recorded.moves])
    time_s, command = recorded.move_time_s()[counted], recorded.command()[counted]
    angular = recorded.unit == "deg"
    moves = moves_of(time_s, np.radians(command) if angular else command, "rad" if angular else "mm")
    torque_nm = recorded.torque_nm()
    if torque_nm is None:
        return Series(recording, moves, optics, still, confirmed=True)
    return Series(
        recording, moves, optics, still, recorded.torque_time_s()[counted], torque_nm[counted], confirmed=True
    )


def _recording(
    recorded: RecordedSeries, sign: Literal[1, -1]
) -> tuple[Recording, AngularOptics | LinearOptics]:
    row, displacement_mm = recorded.configuration, sign * recorded.displacement_mm
    if row["spacing_mm"] is None:
        return recording_of(recorded.time_s, displacement_mm, "mm"), LinearOptics()
    optics = AngularOptics(
        row["spacing_mm"],
        row["u_spacing_mm"] or 0.0,
        1e-3 * row["distance_mm"],
        u_zero_rad=math.radians(U_ZERO_DEG),
    )
    angle_rad = optics.angle_rad(displacement_mm)
    recording = recording_of(recorded.time_s, angle_rad, "rad")
    # A glitch that is left out is no angle that the optics were turned by.
    return recording, optics.over(recording.position)
