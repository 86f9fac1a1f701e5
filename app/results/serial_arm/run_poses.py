"""Targets of a run as a poses CSV (docs/files.md), in the world frame of its fixed nests where it has three."""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final

import numpy as np

from catseye.app.cell.arm import arm_description
from catseye.app.errors import UsageError
from catseye.app.files.tabular import Row, table_csv
from catseye.app.results.runs.run_source import cell_of_run, origin_of_run
from catseye.app.results.scara.export import Export
from catseye.app.store.reader import RunReader
from catseye.calibration.core.types import Floats
from catseye.calibration.kinematics.rotations import angles_of, rotation_of
from catseye.procedures.kit.stored import integer, number_of
from catseye.procedures.serial_arm.nests import (
    FEWEST,
    U_NEST_MM,
    frame_nests,
    have_moved,
    motion_between,
    world_frame,
    world_frame_covariance,
)
from catseye.procedures.serial_arm.records import VISITS, MeasuredNest, MeasuredTarget

_PLACE: Final = ("x_mm", "y_mm", "z_mm")
_U: Final = ("u_x_mm", "u_y_mm", "u_z_mm")
_ANGLES: Final = ("rx_deg", "ry_deg", "rz_deg")
_COVARIANCES: Final = {"cov_xy_mm2": (0, 1), "cov_xz_mm2": (0, 2), "cov_yz_mm2": (1, 2)}

_AT_POSES: Final = tuple(f"{visit}/" for visit in VISITS)
"""Targets there are measured after an approach from below on every axis."""

Places = dict[str, Floats]


def has_targets(reader: RunReader) -> bool:
    """Return whether a run has measured targets of a serial arm."""
    return bool(reader.count(MeasuredTarget.table))


def has_pose_targets(reader: RunReader) -> bool:
    """Return whether a run has measured targets at poses that an arm can be calibrated with."""
    return bool(_pose_targets(reader))


def _pose_targets(reader: RunReader) -> list[dict[str, Any]]:
    """Return the rows of targets at poses; what single axes and frames are found by comes from turning one joint."""
    return [row for row in reader.rows(MeasuredTarget.table) if str(row["step_id"]).startswith(_AT_POSES)]


def pose_rows(reader: RunReader) -> list[Row]:
    """Return the rows of a poses CSV: commanded and read-back joints, targets with their uncertainty.

    A pose that was visited again has another name then: the arm came to it twice, and stood elsewhere each time.

    Raises:
        UsageError: the run has measured no targets.
    """
    stored = _pose_targets(reader)
    if not stored:
        raise UsageError(
            f"{reader.path.name} has measured no targets: name a run of a procedure that measures targets at poses"
        )
    units = [joint.unit for joint in arm_description(cell_of_run(reader).robot.arm).joint]
    world = _world(reader)
    stated = _are_stated(stored)
    correlated = bool(world.motions) or not _without_covariances(stored)
    turned = _are_turned(stored)
    names = (*(_U if stated else ()), *(_COVARIANCES if stated and correlated else ()))
    visits = visit_names(stored)
    return [
        _pose_row(row, name, units, world, names, turned=turned)
        for row, name in zip(stored, visits, strict=True)
    ]


def pose_export(reader: RunReader) -> Export:
    """Return the poses of a run with their targets; see `pose_rows`."""
    rows = pose_rows(reader)
    about = {"run": reader.path.name, "meta": reader.meta}
    return Export(reader.path.name, about, "poses", rows, table_csv(rows), origin_of_run(reader))


@contextmanager
def as_tables(readers: Sequence[RunReader], *, beside: bool = False) -> Iterator[list[Path]]:
    """Give the poses of runs as CSV files of their names, as whoever reads measured poses takes them.

    Names of several runs, and of tables beside them, are alike: each pose stands behind the name of its run.

    Args:
        beside: other tables are read with them.

    Raises:
        UsageError: a run is given twice.
    """
    names = [reader.path.name for reader in readers]
    if twice := [name for name in names if names.count(name) > 1]:
        raise UsageError(f"{twice[0]} is given twice: it would count as two measurements; name it once")
    with TemporaryDirectory(prefix="catseye-poses-") as folder:
        paths = []
        for reader in readers:
            path = Path(folder) / f"{reader.path.name}.csv"
            rows = pose_rows(reader)
            if len(readers) > 1 or beside:
                rows = [{**row, "pose": f"{reader.path.name}/{row['pose']}"} for row in rows]
            path.write_text(table_csv(rows), encoding="utf-8")
            paths.append(path)
        yield paths


def visit_names(stored: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return what the visit of each target is called: as its pose, and a second one as no other pose is."""
    taken = {str(row["pose"]) for row in stored}

    def again(pose: str) -> str:
        return next(name for k in count(2) if (name := f"{pose}/{k}") not in taken)

    second = f"{VISITS[1]}/"
    return [
        again(str(row["pose"])) if str(row["step_id"]).startswith(second) else str(row["pose"])
        for row in stored
    ]


def _pose_row(
    row: Mapping[str, Any],
    name: str,
    units: Sequence[str],
    world: "_World",
    stated: Sequence[str],
    *,
    turned: bool,
) -> Row:
    motion = world.motion(row["nests_round"])
    place = motion[:3, :3] @ np.array([row[name] for name in _PLACE]) + motion[:3, 3]
    values: dict[str, Any] = {"pose": name}
    values |= {f"q{k}_{unit}": value for k, (unit, value) in enumerate(zip(units, row["q"], strict=True), 1)}
    values |= {
        f"q{k}_read_{unit}": value
        for k, (unit, value) in enumerate(zip(units, row["q_read"], strict=True), 1)
    }
    values |= {"target": row["target"], **dict(zip(_PLACE, place.tolist(), strict=True))}
    if stated:
        covariance = motion[:3, :3] @ _covariance(row) @ motion[:3, :3].T
        known = dict(zip(_U, np.sqrt(np.diag(covariance)).tolist(), strict=True))
        known |= {name: float(covariance[i, j]) for name, (i, j) in _COVARIANCES.items()}
        values |= {name: known[name] for name in stated}
    if turned:
        rotation = motion[:3, :3] @ rotation_of(np.array([row[name] for name in _ANGLES]))
        values |= dict(zip(_ANGLES, angles_of(rotation).tolist(), strict=True))
        if stated:
            values["u_deg"] = row["u_deg"]
    return values


def _covariance(row: Mapping[str, Any]) -> Floats:
    """Return the covariance of a place in the instrument's frame, mm²; what it does not state counts as none."""
    found = np.diag([row[name] ** 2 for name in _U])
    for name, (i, j) in _COVARIANCES.items():
        found[i, j] = found[j, i] = row.get(name) or 0.0
    return found


def _are_turned(stored: Sequence[Mapping[str, Any]]) -> bool:
    """Return whether all targets are frames with their orientation."""
    return all(row[name] is not None for row in stored for name in _ANGLES)


def _are_stated(stored: Sequence[Mapping[str, Any]]) -> bool:
    """Return whether the uncertainty of everything that was measured is stated: less could not be weighed."""
    wanted = (*_U, "u_deg") if _are_turned(stored) else _U
    return all(row[name] is not None for row in stored for name in wanted)


def _half_stated(stored: Sequence[Mapping[str, Any]]) -> bool:
    return not _are_stated(stored) and any(row[name] is not None for row in stored for name in (*_U, "u_deg"))


def _without_covariances(stored: Sequence[Mapping[str, Any]]) -> int:
    """Return how many targets have uncertainties of which nobody states whether they are correlated.

    One uncertainty of all coordinates is the same along any axes.
    """
    return sum(
        len({row[name] for name in _U} - {None}) > 1 and any(row.get(name) is None for name in _COVARIANCES)
        for row in stored
    )


@dataclass(frozen=True)
class _World:
    """The world frame of a run.

    Attributes:
        motions: what brings places of each round of nests into it, shape (4, 4); empty without one.
        note: what whoever uses the places has to know of it; empty when nothing.
        covariance: of small shifts, mm, and turns, deg, of the frame, by the noise of its nests; None without one.
    """

    motions: Mapping[int, Floats]
    note: str = ""
    covariance: Floats | None = None

    def motion(self, number: int | None) -> Floats:
        """Return what brings places after a measurement of the nests into it, by the nearest one that saw nests."""
        if not self.motions:
            return np.eye(4)
        return self.motions[_nearest(number or 0, self.motions)]


def world_covariance(reader: RunReader) -> Floats | None:
    """Return how uncertain the world frame of a run's places is by the noise of its nests; None without one.

    Returns:
        Covariance of small shifts, mm, and turns, deg, about its origin, shape (6, 6).
    """
    return _world(reader).covariance


def pose_notes(reader: RunReader) -> list[str]:
    """Return what whoever uses the places of a run has to know of its world frame and of their uncertainties."""
    stored = _pose_targets(reader)
    alone = _without_covariances(stored) if _are_stated(stored) else 0
    notes = [
        _world(reader).note,
        f"the instrument states no covariances for {alone} of {len(stored)} places: errors of their coordinates are "
        "taken as independent along its axes"
        if alone
        else "",
        "uncertainties are stated for only some of the places and rotations, so none is used and the scatter of "
        "the fit counts: state u_mm, and u_deg for poses, in [tracker.settings] for the next run"
        if _half_stated(stored)
        else "",
    ]
    return [f"{reader.path.name}: {note}" for note in notes if note]


def _world(reader: RunReader) -> _World:
    """Return the world frame of the first three nests of the cell that were seen and do not lie on a line."""
    rounds, u_mm = _rounds(reader)
    tried = {row["nests_round"] for row in _pose_targets(reader)} - {None}
    names = _nest_names(reader, rounds, measured=bool(tried))
    if len(names) < FEWEST:
        return _World({})
    first = rounds[min(rounds)] if rounds else {}
    drifted = {number for number, places in rounds.items() if have_moved(first, places, u_mm)}
    known = _known_places(names, rounds, drifted)
    hidden = ", ".join(name for name in names if name not in known)
    frame = frame_nests(known)
    if frame is None:
        left = f", and {', '.join(known)} lie on a line" if len(known) >= FEWEST else ""
        return _World(
            {},
            f"no world frame: of the fixed nests {hidden or 'none'} was hidden in every measurement{left}, so places "
            "are in the instrument's frame and a drift stays in them; use this run without others, and clear the "
            "line of sight for the next",
        )
    world = world_frame(*(known[name] for name in frame))
    motions: dict[int, Floats] = dict.fromkeys(rounds, world)
    notes = [
        f"measurement {number} of the nests saw none of them: places after it stand in the world frame by "
        f"measurement {_nearest(number, rounds)}, and a drift between the two stays in them"
        for number in sorted(tried - rounds.keys())
    ]
    for number in sorted(drifted):
        back = motion_between(known, rounds[number])
        if back is None:
            notes.append(f"measurement {number} of the nests saw too few of them to take the drift since out")
        else:
            motions[number] = world @ back
    if hidden and frame != tuple(names[:FEWEST]):
        notes.append(
            f"the world frame lies on {', '.join(frame)}, since {hidden} was hidden in every "
            "measurement: it is another one than that of runs that saw it, so do not calibrate them together"
        )
    nests = np.array([known[name] for name in frame])
    noise = np.array([_nest_covariance(reader, name, drifted) for name in frame])
    return _World(motions, "; ".join(notes), world_frame_covariance(nests, noise))


def _nest_covariance(reader: RunReader, name: str, drifted: set[int]) -> Floats:
    """Return the covariance of the place of a nest, mm², shape (3, 3): that of a mean where it has not moved."""
    seen = [row for row in reader.rows(MeasuredNest.table) if row["face"] == 1 and row["nest"] == name]
    steady = [row for row in seen if integer(row["nests_round"]) not in drifted]
    used = [{**row, **{u: U_NEST_MM if row[u] is None else row[u] for u in _U}} for row in steady or seen[:1]]
    return np.asarray(sum(map(_covariance, used)) / len(used) ** 2)


def _nearest(number: int, rounds: Iterable[int]) -> int:
    return min(rounds, key=lambda seen: abs(seen - number))


def _nest_names(reader: RunReader, rounds: Mapping[int, Places], *, measured: bool) -> tuple[str, ...]:
    """Return the nests in the order of the cell file: whichever are hidden, the frame of all runs is one."""
    tracker = cell_of_run(reader).tracker
    stated = () if tracker is None else tuple(nest.name for nest in tracker.nest)
    seen = dict.fromkeys(name for _, places in sorted(rounds.items()) for name in places)
    return stated if measured and seen.keys() <= set(stated) else tuple(seen)


def _known_places(names: Sequence[str], rounds: Mapping[int, Places], drifted: set[int]) -> Places:
    """Return the nests in the first round's frame, mm, in their order; those never seen are left out.

    Nests that have not moved are known better by their mean.
    """
    steady = [places for number, places in rounds.items() if number not in drifted]
    seen = {name: [one[name] for one in steady if name in one] for name in names}
    known = {name: np.asarray(np.mean(places, axis=0)) for name, places in seen.items() if places}
    for number in sorted(drifted):
        back = motion_between(known, rounds[number])
        if back is not None:
            moved = {name: back[:3, :3] @ one + back[:3, 3] for name, one in rounds[number].items()}
            known = moved | known
    return {name: known[name] for name in names if name in known}


def _rounds(reader: RunReader) -> tuple[dict[int, Places], float]:
    rounds: dict[int, Places] = defaultdict(dict)
    squares = []
    for row in reader.rows(MeasuredNest.table):
        if row["face"] != 1:
            continue
        rounds[integer(row["nests_round"])][str(row["nest"])] = np.array([row[name] for name in _PLACE])
        squares += [(U_NEST_MM if row[name] is None else number_of(row, name)) ** 2 for name in _U]
    return dict(rounds), float(np.sqrt(np.mean(squares))) if squares else U_NEST_MM
