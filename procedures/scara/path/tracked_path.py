"""A path that the interferometer itself measures: the beam follows a reflector along it."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.context import Context, Measurement
from catseye.procedures.kit.errors import PlanError
from catseye.procedures.kit.records import Row, row_of, table_of
from catseye.procedures.kit.stored import number_of
from catseye.procedures.scara.beam.nests import Nests
from catseye.procedures.scara.bench import Reflector, ScaraBench
from catseye.procedures.scara.following.follower import Follower
from catseye.procedures.scara.following.recovery import Recovery
from catseye.procedures.scara.motion.approach import Command, Waypoint
from catseye.procedures.scara.motion.point_row import distance_of
from catseye.procedures.scara.motion.tracking import plan_track
from catseye.procedures.scara.motion.visits import Visit, break_warnings, plan_visits
from catseye.procedures.scara.records import PathPosition

_COLUMNS = frozenset(column.name for column in table_of(PathPosition).columns)

_FEWEST_SEEN = 0.5
"""A reflector that sees less than this share of the path says too little about it."""

NO_ENTRIES: Final[Mapping[int, Pose]] = MappingProxyType({})
"""Of a path of one line."""

_ATTEMPTS = 3
"""Failures in a row before the operator is asked."""


@dataclass(frozen=True)
class PathPoint:
    """A command on the path.

    Attributes:
        x_mm: command position.
        y_mm: command position.
        theta1_deg: J1 of the nominal arm.
        theta2_deg: J2 of the nominal arm.
        direction1: sign of the last change of J1.
        direction2: sign of the last change of J2.
    """

    x_mm: float
    y_mm: float
    theta1_deg: float
    theta2_deg: float
    direction1: int
    direction2: int

    @property
    def line(self) -> int | None:
        """Line that the point belongs to; None for a path that names none."""
        return None

    @property
    def j3_mm(self) -> float | None:
        """J3; None for the height of the bench."""
        return None

    @property
    def j4_deg(self) -> float | None:
        """J4; None for 0, or where the beam's aim says it."""
        return None

    @property
    def tool(self) -> dict[str, float]:
        """J3 and J4 by the names of their columns, as far as the path says them."""
        stated = {"j3_mm": self.j3_mm, "j4_deg": self.j4_deg}
        return {name: value for name, value in stated.items() if value is not None}

    def pose(self, bench: ScaraBench) -> Pose:
        """Return all joints at the point."""
        j3_mm = bench.j3_mm if self.j3_mm is None else self.j3_mm
        return self.theta1_deg, self.theta2_deg, j3_mm, self.j4_deg or 0.0

    def position(
        self,
        pass_number: int,
        measured_mm: tuple[float, float] | None = None,
        u_mm: float | None = None,
        further: Row | None = None,
    ) -> PathPosition:
        """Return the record of the point.

        Args:
            pass_number: of the drive along the path, from 0.
            measured_mm: x and y where an independent instrument saw the arm; None where a distance was measured.
            u_mm: standard uncertainty of each coordinate; None when it is not stated.
        """
        x_meas_mm, y_meas_mm = measured_mm or (None, None)
        return PathPosition(
            x_mm=self.x_mm,
            y_mm=self.y_mm,
            theta1_deg=self.theta1_deg,
            theta2_deg=self.theta2_deg,
            direction1=self.direction1,
            direction2=self.direction2,
            x_meas_mm=x_meas_mm,
            y_meas_mm=y_meas_mm,
            u_mm=u_mm,
            line=self.line,
            extra={**self.tool, **(further or {}), "pass_number": pass_number},
        )


@dataclass(frozen=True)
class TrackedPath:
    """All passes of a path with the beam on one reflector.

    Attributes:
        reflector: what is aimed at.
        visits: points that see it, in order; the index counts over all passes.
        blind: points that do not; they are left out.
        planned_breaks: segments beyond the first.
    """

    reflector: Reflector
    visits: tuple[Visit, ...]
    blind: tuple[Command, ...]
    planned_breaks: int

    @property
    def duration_s(self) -> float:
        """Expected time of motion, settling and dwell, s."""
        return sum(visit.duration_s for visit in self.visits)

    def warnings(self) -> list[str]:
        """Return what the operator should know before it starts."""
        texts = []
        if self.blind:
            first = self.blind[0]
            texts.append(
                f"reflector {self.reflector.name}: {len(self.blind)} points of the path are blind and left out, the "
                f"first at θ1 = {first.theta1_deg:.2f}°, θ2 = {first.theta2_deg:.2f}°"
            )
        return [*texts, *break_warnings(self.reflector, self.planned_breaks)]


def plan_tracked_path(
    run_in: Pose,
    points: tuple[PathPoint, ...],
    passes: int,
    bench: ScaraBench,
    name: str = "",
    entries: Mapping[int, Pose] = NO_ENTRIES,
) -> TrackedPath:
    """Plan how the beam follows a reflector over all passes.

    Args:
        run_in: from where the first point of each pass is approached.
        points: commands of one pass.
        name: of the reflector; empty for the one that sees most of the path, with the fewest breaks.
        entries: from where further lines are entered, by the number of their first point.

    Raises:
        PlanLimitError: J4 has no branch inside its limits.
        PlanError: no such reflector, or it sees less than half of the path.
    """
    stops = _stops({0: run_in, **entries}, points, passes)
    found: list[TrackedPath] = []
    refusals: list[PlanError] = []
    for reflector in bench.chosen((name,) if name else ()):
        try:
            found.append(_followed(stops, bench, reflector))
        except PlanError as error:
            refusals.append(error)
    if not found:
        raise refusals[0]
    return _require_sight(max(found, key=lambda one: (len(one.visits), -one.planned_breaks)))


class TrackedCampaign:
    """Drives a tracked path and records its distances.

    Args:
        points: commands of one pass.
    """

    def __init__(
        self, ctx: Context, bench: ScaraBench, tracked: TrackedPath, points: tuple[PathPoint, ...]
    ) -> None:
        self._ctx = ctx
        self._tracked = tracked
        self._points = points
        self._follower = Follower(ctx, bench, tracked.reflector)
        self._recovery = Recovery(ctx, bench, tracked.reflector, self._follower, _ATTEMPTS)
        self._nests = Nests(ctx, bench)

    async def run(self) -> None:
        """Measure every point.

        Raises:
            BeamLostError: the operator ends the run since the beam does not come back.
            WayBlockedError: the arm cannot be led to a point.
        """
        for text in self._tracked.warnings():
            await self._ctx.warn(text)
        before: Visit | None = None
        done_s = 0.0
        for visit in self._tracked.visits:
            await self._visit(visit, before)
            before = visit
            done_s += visit.duration_s
            extra_s = self._follower.extra_s
            text = f"path point {visit.command.index + 1}/{self._tracked.visits[-1].command.index + 1}"
            self._ctx.progress(done_s + extra_s, self._tracked.duration_s + extra_s, text)

    async def _visit(self, visit: Visit, before: Visit | None) -> None:
        pass_number, number = divmod(visit.command.index, len(self._points))
        point = self._points[number]
        step_id = f"path/{pass_number}/{number:04d}"

        async def action() -> Row:
            await self._nests.place(self._tracked.reflector)
            found = await self._recovery.obtain(visit, before, step_id)
            segment = self._follower.segment
            if not isinstance(found, Measurement):
                return {"measured": False, "segment": segment, "reason": found.reason}
            self._record(point, pass_number, visit.command, found)
            return {"measured": True, "segment": segment, "displacement_mm": found.displacement_mm}

        result = await self._ctx.step(step_id, f"x {point.x_mm:g} mm, y {point.y_mm:g} mm", action)
        # A stored point took its segment's number; the next zero of a resumed run has to take another.
        self._follower.segment = max(self._follower.segment, int(number_of(result, "segment")))

    def _record(self, point: PathPoint, pass_number: int, command: Command, measured: Measurement) -> None:
        follower = self._follower
        distance = distance_of(
            self._tracked.reflector.name, follower.segment, command, follower.sent, measured
        )
        further = {name: value for name, value in row_of(distance).items() if name not in _COLUMNS}
        self._ctx.record(point.position(pass_number, further=further))


def _stops(entries: Mapping[int, Pose], points: tuple[PathPoint, ...], passes: int) -> tuple[Waypoint, ...]:
    stops: list[Waypoint] = []
    for pass_number in range(passes):
        for number, point in enumerate(points):
            if (entry := entries.get(number)) is not None:
                stops.append(Waypoint(entry[0], entry[1], None))
            theta = (point.theta1_deg, point.theta2_deg)
            command = Command(pass_number * len(points) + number, *theta, point.direction1, point.direction2)
            stops.append(Waypoint(*theta, command))
    return tuple(stops)


def _followed(stops: tuple[Waypoint, ...], bench: ScaraBench, reflector: Reflector) -> TrackedPath:
    track = plan_track(stops, bench, reflector, subdivide=True)
    visits, blind = plan_visits(stops, track, bench, reflector)
    return TrackedPath(reflector, visits, blind, max(0, sum(not visit.tracked for visit in visits) - 1))


def _require_sight(tracked: TrackedPath) -> TrackedPath:
    seen, reflector = len(tracked.visits), tracked.reflector
    if seen >= _FEWEST_SEEN * (seen + len(tracked.blind)):
        return tracked
    raise PlanError(
        f"reflector {reflector.name} at ({reflector.x_mm:g}, {reflector.y_mm:g}) mm can be seen from only {seen} of "
        f"{seen + len(tracked.blind)} points of the path: choose another path (x_mm, y_from_mm, y_to_mm), another "
        "reflector (param reflector), or put that one elsewhere"
    )
