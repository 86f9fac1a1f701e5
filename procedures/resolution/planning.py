"""Making the places and series of a campaign."""

import math
from collections.abc import Callable, Iterable, Sequence
from typing import Annotated, Final

from pydantic import BaseModel, ConfigDict, Field

from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.bench import Bench
from catseye.procedures.kit.errors import PlanError
from catseye.procedures.resolution.campaign_plan import (
    CampaignPlan,
    Place,
    Series,
    ends_of,
    require_possible,
)
from catseye.procedures.resolution.places import axis_number, chosen_axes, chosen_places, standing, turned

Degrees = Annotated[float, Field(ge=-720.0, le=720.0)]

SIGNS: Final = {1: "+", -1: "-"}

LEAST_REACH: Final = 5.0
"""To either side of a place, deg or mm: so far the beam is checked at least."""

_CHECK_DEG: Final = 1.0
"""Between two looks at the beam while its range is checked."""


class CampaignParams(BaseModel):
    """What may be chosen for every test of resolution."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    standstill_s: float = Field(
        60.0,
        ge=15.0,
        le=600.0,
        title="Standstill before, s",
        description="standstill before the first move, s",
    )
    dwell_s: float = Field(
        5.0, ge=1.0, le=60.0, title="Standstill after, s", description="standstill after each move, s"
    )
    rate_hz: float = Field(
        25.0,
        ge=20.0,
        le=1000.0,
        title="Query rate, Hz",
        description="rate at which the program queries a counter that does not stream, Hz",
    )
    accept_slow_counter: bool = Field(
        default=False,
        title="Accept a slow counter",
        description="record even if fewer readings arrive than the evaluation needs",
    )


class JointParams(CampaignParams):
    """What may be chosen for tests of joints."""

    joints: list[str] = Field([], title="Axes", description="axes to test; empty: all rotary axes")
    positions: list[str] = Field(
        [], title="Positions K1 … K5", description="positions of each axis to test, K1 … K5; empty: all"
    )
    pose_deg: list[Degrees] = Field(
        [],
        title="Other axes at, deg",
        description="positions of the axes that are not tested, one value per axis; empty: the middles of their "
        "ranges",
    )
    run_in_deg: float = Field(
        5.0,
        ge=0.5,
        le=10.0,
        title="Run-in, deg",
        description="motion in the test's direction before the test, which takes up play, deg",
    )


MakeSeries = Callable[[str, str, Pose], Iterable[Series]]
"""Returns the series at a place: axis, name of the position, pose."""


def joint_campaign(bench: Bench, params: JointParams, make: MakeSeries) -> CampaignPlan:
    """Return the campaign of a test over joints and positions, every pose and way of it checked.

    Raises:
        PlanLimitError: a pose lies outside the limits.
        PlanError: a name is unknown, bodies come too near each other, or the cell has no angular optics.
    """
    rest = standing(bench, params.pose_deg)
    places = []
    for axis in chosen_axes(bench, params.joints):
        for name, value in chosen_places(bench, axis, params.positions):
            pose = turned(bench, rest, axis, value)
            series = tuple(make(axis, name, pose))
            reached = _offsets(bench, axis, value, series)
            check = tuple(turned(bench, pose, axis, value + by) for by in _to_and_fro(reached))
            places.append(Place(axis, name, pose, value, "deg", "angular", check, series))
    return campaign(bench, params, places)


def campaign(bench: Bench, params: CampaignParams, places: Sequence[Place]) -> CampaignPlan:
    """Return a campaign over places, every pose and way of it checked.

    Raises:
        PlanLimitError: a pose lies outside the limits.
        PlanError: there is nothing to do, bodies come too near each other, or optics are missing.
    """
    if not all(series.orders for place in places for series in place.series):
        raise PlanError("a series has no step that this controller can command: begin with a larger one")
    return require_possible(
        CampaignPlan(
            bench,
            tuple(places),
            params.standstill_s,
            params.dwell_s,
            params.rate_hz,
            params.accept_slow_counter,
        )
    )


def reach(offsets: Sequence[float], sign: int) -> float:
    """Return how far the beam is checked to one side of a place, deg or mm.

    Args:
        offsets: from the place, of where its series lead.
        sign: 1 or -1: the side.
    """
    return max(LEAST_REACH, *(sign * by for by in offsets))


def _offsets(bench: Bench, axis: str, value: float, series: Sequence[Series]) -> list[float]:
    """Return how far run-ins and moves of series lead from a place, deg."""
    number = axis_number(bench, axis)
    poses = (pose for one in series for pose in (*one.run_in, *ends_of(bench, axis, one)))
    return [pose[number] - value for pose in poses]


def _to_and_fro(offsets: Sequence[float]) -> list[float]:
    """Return offsets up to the reach, back to 0, down to the reach of the other side and back to 0."""
    found: list[float] = []
    for sign in SIGNS:
        far = reach(offsets, sign)
        count = math.ceil(far / _CHECK_DEG)
        out = [sign * far * number / count for number in range(1, count + 1)]
        found += [*out, *reversed(out[:-1]), 0.0]
    return found
