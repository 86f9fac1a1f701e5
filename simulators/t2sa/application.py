"""The emulated T2SA beside SpatialAnalyzer: every command of the sheet (`trackers_ballbar`, section 5).

Not known, and assumed here: where the sheet shows no text of an answer, READY; the numbers of errors beyond 201 are
those that the public client lists; a measurement that is halted is answered by ERR-330 before HALT is; after a
shutdown (`!LST:2`) everything but `!RESET_T2SA` is refused; reports of poses are in mm and degrees. Settings that the
public client sends are taken and change nothing; its two indices come with and without a sign.
"""

from collections.abc import Callable
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta

from catseye.simulators.survey import Place
from catseye.simulators.t2sa.commands import (
    BUSY,
    GROUP_FAILED,
    HALTED,
    NO_FRAME,
    NO_GROUP,
    NO_TEMPLATE,
    NOT_CONNECTED,
    NOT_FOUND,
    NOT_SAVED,
    POINT_FAILED,
    REJECTED,
    Command,
    bad,
    good,
)
from catseye.simulators.t2sa.instruments import Instruments, Pose

PLAN_S = 2.0
"""What a measurement plan takes, and a check."""

_NUMBERS = {
    "SET_RANDOMIZE_POINTS": 1,
    "SET_POWER_LOCK": 1,
    "SET_NUM_SAMPLES": 1,
    "SET_NUM_ITERATIONS": 1,
    "!SET_2FACE_TOL": 3,
    "!SET_DRIFT_TOL": 2,
    "!SET_LS_TOL": 2,
    "!SET_STATION_LOCK": 1,
}
_TEXTS = {
    "!NEW_STATION": 0,
    "!CLERCL": 0,
    "!SAVE_SETTINGS": 0,
    "!SINGLE_POINT_MEAS_PROFILE": 1,
    "!GEN_REPORT": 1,
    "!LOAD_TRACKER_COMPENSATION": 1,
}
"""Settings by the number of their arguments: numbers, and names."""

_BEGAN = datetime(2026, 1, 1, 8, 0, tzinfo=UTC)


@dataclass
class Measurement:
    """Something that takes time.

    Attributes:
        due_s: bench time at which it is done.
        answer: what its client receives then; None while it is under way.
    """

    due_s: float
    answer: bytes | None = None


Said = bytes | Measurement


class Application:
    """What all clients share.

    Args:
        instruments: of SpatialAnalyzer.
        warm_up_s: how long a laser that was switched on warms.
        point_s: how long a point is measured.
        lit: the laser is on and warm at the start.
    """

    def __init__(self, instruments: Instruments, *, warm_up_s: float, point_s: float, lit: bool) -> None:
        self._instruments = instruments
        self._warm_up_s = warm_up_s
        self._point_s = point_s
        self._warm_s: float | None = 0.0 if lit else None
        self._shut = False
        self._points: dict[str, Place] = {}
        self._poses: dict[str, Pose] = {}
        self._frame = "WORLD"
        self._index = 0
        self._measurement: Measurement | None = None
        self._verbs: dict[str, tuple[int, Callable[..., Said]]] = {
            "!SET_SIM": (1, lambda _on: good("ACK300 EMULATOR")),
            **{name: (count, _numbers) for name, count in _NUMBERS.items()},
            **{name: (count, lambda *_texts: good("ACK300")) for name, count in _TEXTS.items()},
            "!RESET_T2SA": (0, self._reset),
            "?STAT": (0, self._status),
            "?LSTA": (0, lambda: good(self._laser)),
            "!LST": (1, self._switch_laser),
            "!CMDEXE": (1, self._run_plan),
            "!2FACE_CHECK": (1, lambda group: self._check(group, "two face check")),
            "!MEAS_DRIFT": (1, lambda group: self._check(group, "drift scan")),
            "!HALT": (0, self._halt),
            "!MEAS_SINGLE_POINT": (3, self._measure_point),
            "?POINT_POS": (3, self._point_of),
            "?POINT_DELTA": (6, self._delta),
            "?POS": (1, self._report),
            "?OFFSET": (2, self._offset),
            "!SET_REFERENCE_GROUP": (1, self._set_reference),
            "!SET_WORKING_FRAME": (1, self._set_frame),
            "!PUBLISH_ALT_AZ_ROT": (3, self._publish),
            "!SAVE_SA_JOBFILE": (1, lambda name: self._file(name, NOT_SAVED)),
            "!LOAD_SA_TEMPLATE_FILE": (1, lambda name: self._file(name, NO_TEMPLATE)),
            **dict.fromkeys(("!SET_MEAS_INDEX", "SET_MEAS_INDEX"), (1, self._set_index)),
            **dict.fromkeys(("!INC_MEAS_INDEX", "INC_MEAS_INDEX"), (1, self._increase_index)),
        }

    @property
    def now_s(self) -> float:
        """Bench time, s."""
        return self._instruments.bench.time_s

    @property
    def busy(self) -> bool:
        """A measurement is under way."""
        return self._measurement is not None and self._measurement.answer is None

    def carry_out(self, command: Command) -> Said:
        """Carry out a command; return its answer, or what it begins."""
        count, verb = self._verbs.get(command.verb, (0, None))
        if verb is None:
            return bad(REJECTED, f"Unsupported command {command.verb!r}")
        if len(command.arguments) != count:
            return bad(REJECTED, f"{command.verb} takes {count} arguments")
        if self._shut and command.verb != "!RESET_T2SA":
            return bad(NOT_CONNECTED, "Not connected to SA")
        return verb(*command.arguments)

    @property
    def _laser(self) -> str:
        if self._warm_s is None:
            return "LOFF"
        left_s = self._warm_s - self.now_s
        return "LON" if left_s <= 0.0 else f"WARM, {left_s:.2f} seconds"

    @property
    def _stamp(self) -> str:
        return f"{_BEGAN + timedelta(seconds=self.now_s):%m/%d/%Y %I:%M:%S %p}"

    def _reset(self) -> bytes:
        self._shut = False
        self._halt()
        return good("ACK300")

    def _status(self) -> bytes:
        return bad(BUSY, "Command rejected. SA is busy.") if self.busy else good("Instrument is connected")

    def _switch_laser(self, value: str) -> bytes:
        if value == "1":
            if self._warm_s is None:
                self._warm_s = self.now_s + self._warm_up_s
            return good("Tracker Interface Started: True")
        if value not in {"0", "2"}:
            return bad(REJECTED, f"Invalid input argument: {value}.")
        self._warm_s = None
        self._shut = value == "2"
        return good("Tracker Interface Stopped: True")

    def _halt(self) -> bytes:
        """End what is under way."""
        if self._measurement is not None and self._measurement.answer is None:
            self._measurement.answer = bad(HALTED, "Measurement halted")
            self._measurement.due_s = self.now_s
        return good("READY")

    def _refusal(self) -> bytes:
        """Return why nothing can be measured now; empty when it can."""
        if self.busy:
            return bad(BUSY, "Command rejected. SA is busy.")
        return b"" if self._laser == "LON" else bad(REJECTED, f"T2SA not ready: Laser status {self._laser}.")

    def _begin(self, duration_s: float, finish: Callable[[], bytes]) -> Measurement:
        begun = Measurement(self.now_s + duration_s)

        def end() -> None:
            if begun.answer is None:
                begun.answer = finish()

        self._measurement = begun
        self._instruments.bench.call_at(begun.due_s, end)
        return begun

    def _run_plan(self, group: str) -> Said:
        if not self._instruments.has_group(group):
            return bad(NOT_FOUND, f"No point group {group}.")

        def finish() -> bytes:
            pose = self._instruments.pose(group, PLAN_S)
            if pose is None:
                return bad(GROUP_FAILED, f"Error executing measure plan for {group}")
            self._poses[group] = pose
            return good(f"Successfully ran CMD {group}", 106)

        return self._refusal() or self._begin(PLAN_S, finish)

    def _check(self, group: str, what: str) -> Said:
        if not self._instruments.has_group(group):
            return bad(NOT_FOUND, f"No point group {group}.")
        done = good(f"Successfully ran {what} for {group}", 106)
        return self._refusal() or self._begin(PLAN_S, lambda: done)

    def _measure_point(self, _collection: str, _group: str, name: str) -> Said:
        if not self._instruments.has_point(name):
            return bad(NOT_FOUND, f"No point {name}.")
        if refusal := self._refusal():
            return refusal
        self._instruments.begin(name)

        def finish() -> bytes:
            place = self._instruments.point(self._point_s)
            if place is None:
                return bad(POINT_FAILED, f"Measurement of point {name} failed")
            self._points[name] = place
            return self._single(name, place)

        return self._begin(self._point_s, finish)

    def _point_of(self, _collection: str, _group: str, name: str) -> bytes:
        place = self._points.get(name)
        return bad(NOT_FOUND, f"No point {name}.") if place is None else self._single(name, place)

    def _delta(self, *names: str) -> bytes:
        one, other = self._points.get(names[2]), self._points.get(names[5])
        if one is None or other is None:
            return bad(NOT_FOUND, f"No point {names[2] if one is None else names[5]}.")
        x, y, z = (b - a for a, b in zip(one, other, strict=True))
        return self._single(names[5], (x, y, z))

    def _single(self, name: str, place: Place) -> bytes:
        values = ",".join(f"{value:.6f}" for value in place)
        return good(f"Single Point Measurement {name} result {values} {self._stamp} True")

    def _report(self, group: str) -> bytes:
        if self.busy:
            return bad(BUSY, "Command rejected. SA is busy.")
        pose = self._poses.get(group)
        return (
            bad(NOT_FOUND, f"No point group {group}.") if pose is None else self._offset_report(group, pose)
        )

    def _offset(self, group: str, reference: str) -> bytes:
        """Return the difference of two reports; nobody says what SpatialAnalyzer would do with large rotations."""
        one, other = self._poses.get(group), self._poses.get(reference)
        if one is None or other is None:
            return bad(NOT_FOUND, f"No point group {group if one is None else reference}.")
        x, y, z, rx, ry, rz = (a - b for a, b in zip(one, other, strict=True))
        return self._offset_report(group, (x, y, z, rx, ry, rz))

    def _offset_report(self, group: str, pose: Pose) -> bytes:
        names = ("X", "Y", "Z", "Rx", "Ry", "Rz")
        values = ";".join(f"{name}:{value:.6f}" for name, value in zip(names, pose, strict=True))
        return good(f"Object Offset Report Frame{group.upper()}_{self._index};{values};{self._stamp}")

    def _set_reference(self, group: str) -> bytes:
        return good("READY") if self._instruments.has_group(group) else bad(NO_GROUP, f"No group {group}.")

    def _set_frame(self, frame: str) -> bytes:
        if frame not in {"", "WORLD"}:
            return bad(NO_FRAME, "POS: NotFound")
        self._frame = frame
        return good("READY")

    def _publish(self, *angles: str) -> bytes:
        return _numbers(*angles, done="READY")

    def _file(self, name: str, code: int) -> bytes:
        return good("READY") if name.startswith("C:") else bad(code, f"{name} not found or not saved.")

    def _set_index(self, text: str) -> bytes:
        if not (text.isascii() and text.isdigit() and len(text) < 9):
            return bad(REJECTED, f"No index: {text}.")
        self._index = int(text)
        return good(f"Set Point Group Index  ->  Set Group Idx to {self._index}.", 111)

    def _increase_index(self, text: str) -> bytes:
        if not (text.isascii() and text.isdigit() and len(text) < 9):
            return bad(REJECTED, f"No index: {text}.")
        self._index += int(text)
        return good(f"Incremented Point Group Index  ->  Incremented group index by {text}", 104)


def _numbers(*texts: str, done: str = "ACK300") -> bytes:
    """Take numbers."""
    try:
        _ = [float(text) for text in texts]
    except ValueError:
        return bad(REJECTED, f"Failed to convert a value to float: {'/'.join(texts)}.")
    return good(done)
