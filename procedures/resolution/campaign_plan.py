"""A campaign: places where optics are set up, and the series that are recorded at each of them."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from catseye.drivers.roles.pose import Pose, Unit, out_of_range
from catseye.procedures.kit.bench import AngularOptics, Bench, LinearOptics
from catseye.procedures.kit.errors import PlanError, PlanLimitError
from catseye.procedures.kit.motion.clear_way import require_clear_way
from catseye.procedures.kit.motion.motion_time import way_time_s
from catseye.procedures.kit.motion.steps import Vector, axis_target, line_target, step_time_s
from catseye.procedures.kit.tasks import OpticsKind
from catseye.procedures.resolution.records import Test


@dataclass(frozen=True)
class Order:
    """One move of a series.

    Attributes:
        sequence: of a test that goes there and back, from 1; 0 for moves that only lead to its beginning.
        command: signed size, deg or mm.
        target: pose to drive to; None when the size is added to the measured position.
    """

    sequence: int
    command: float
    target: Pose | None = None


@dataclass(frozen=True)
class Series:
    """What is recorded in one go.

    Attributes:
        step_id: of its step.
        title: for people.
        test: which test.
        direction: 1 or -1: in which the place is approached.
        run_in: poses driven through before the recording; the last one is the place.
        orders: its moves.
        along: direction of straight steps in the base frame, of unit length; None where an axis is stepped.
        amplitude: of equal steps, deg or mm; None for a series that decays.
    """

    step_id: str
    title: str
    test: Test
    direction: int
    run_in: tuple[Pose, ...]
    orders: tuple[Order, ...]
    along: Vector | None = None
    amplitude: float | None = None


@dataclass(frozen=True)
class Place:
    """Where optics are set up once.

    Attributes:
        joint: axis that is tested, or X, Y, Z of the base frame.
        name: of the position.
        pose: of the arm.
        value: of the axis there, deg or mm; None for straight series.
        unit: of the steps.
        optics: that are set up.
        range_check: poses driven through, to and fro, to see that the beam is kept; it ends at the place.
        series: recorded there.
    """

    joint: str
    name: str
    pose: Pose
    value: float | None
    unit: Unit
    optics: OpticsKind
    range_check: tuple[Pose, ...]
    series: tuple[Series, ...]


@dataclass(frozen=True)
class CampaignPlan:
    """All places with their series.

    Attributes:
        bench: what it was made from.
        places: in order.
        standstill_s: recorded before the first move of each series.
        dwell_s: standstill after each move.
        rate_hz: at which a counter is asked that sends nothing by itself.
        accept_slow_counter: record even if fewer readings come than the evaluation needs.
    """

    bench: Bench
    places: tuple[Place, ...]
    standstill_s: float
    dwell_s: float
    rate_hz: float
    accept_slow_counter: bool = False

    @property
    def duration_s(self) -> float:
        """Expected bench time of all series, s; setting optics up comes on top."""
        return sum(self.series_s(series) for place in self.places for series in place.series)

    def series_s(self, series: Series) -> float:
        """Return the expected bench time of one series, s."""
        steps_s = sum(step_time_s(order.command) + self.dwell_s for order in series.orders)
        return self.standstill_s + steps_s + _way_s(self.bench, series.run_in)

    def optics(self, place: Place) -> AngularOptics | LinearOptics:
        """Return the optics of a place.

        Raises:
            PlanError: the cell has none.
        """
        bench = self.bench
        found = bench.angular_optics if place.optics == "angular" else bench.linear_optics
        if found is None:
            raise PlanError(f"[{place.optics}_optics] is missing: add it to the cell file {bench.name}")
        return found

    def dead_path_mm(self, place: Place) -> float:
        """Return what the air changes in a count at rest: the two beams of angular optics share their way."""
        return 0.0 if place.optics == "angular" else self.optics(place).distance_mm


def require_possible(plan: CampaignPlan) -> CampaignPlan:
    """Check every pose and way of a campaign; return it.

    Raises:
        PlanLimitError: a pose lies outside the limits; the place is named.
        PlanError: bodies come too near each other, or optics are missing.
    """
    before: tuple[Pose, ...] = ()
    for place in plan.places:
        plan.optics(place)
        ways = [*before, place.pose, *place.range_check]
        for series in place.series:
            ways += [*series.run_in, *ends_of(plan.bench, place.joint, series)]
        _require_in_range(plan.bench, place, ways)
        _require_clear(plan.bench, place, ways)
        before = (ways[-1],)
    return plan


def ends_of(bench: Bench, joint: str, series: Series) -> tuple[Pose, ...]:
    """Return where the moves of a series lead: its absolute targets, or the end of all increments.

    Args:
        joint: axis that is tested, where the series steps one.
    """
    targets = tuple(order.target for order in series.orders if order.target is not None)
    if targets:
        return targets
    start, total = series.run_in[-1], sum(order.command for order in series.orders)
    if series.along is None:
        return (axis_target(bench.arm.axes, start, joint, total),)
    x, y, z = series.along
    return (line_target(bench, start, (total * x, total * y, total * z)),)


def _require_in_range(bench: Bench, place: Place, ways: Iterable[Pose]) -> None:
    for pose in ways:
        if wrong := out_of_range(bench.arm.axes, pose):
            raise PlanLimitError(
                f"{place.joint} at {place.name}: {'; '.join(wrong)}: leave this position out, choose pose_deg or a "
                "smaller run-in, or widen the limits in the cell file"
            )


def _require_clear(bench: Bench, place: Place, ways: list[Pose]) -> None:
    try:
        require_clear_way(ways, bench)
    except PlanError as error:
        raise PlanError(f"{place.joint} at {place.name}: {error}") from error


def _way_s(bench: Bench, way: tuple[Pose, ...]) -> float:
    return way_time_s(bench.arm, np.array(way)) if len(way) > 1 else 0.0
