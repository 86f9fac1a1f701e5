"""Cartesian resolution: straight steps of the tool along the axes of the base frame, seen by linear optics."""

from collections.abc import Sequence
from typing import Annotated, Final, Literal

from pydantic import Field

from catseye.drivers.roles.pose import Pose, pose_of
from catseye.procedures.kit.beam.loss import LOSS_TEXTS
from catseye.procedures.kit.bench import Bench
from catseye.procedures.kit.context import Context
from catseye.procedures.kit.errors import PlanError
from catseye.procedures.kit.motion.steps import Vector, line_target
from catseye.procedures.kit.needs import Needs
from catseye.procedures.kit.procedure import Procedure
from catseye.procedures.kit.recording import Recorded
from catseye.procedures.resolution.campaign import carry_out
from catseye.procedures.resolution.campaign_plan import CampaignPlan, Order, Place, Series
from catseye.procedures.resolution.explained import RESOLUTION_CARTESIAN
from catseye.procedures.resolution.planning import SIGNS, CampaignParams, Degrees, campaign, reach
from catseye.procedures.resolution.questions import CAMPAIGN
from catseye.procedures.resolution.records import Configuration, Move
from catseye.procedures.resolution.step_sizes import FIRST_MM, decaying
from catseye.procedures.resolution.way import DOSSIER, EVALUATE, REPORT, STRAIGHT

Direction = Literal["+X", "-X", "+Y", "-Y", "+Z", "-Z"]

_MOST_CHANGE: Final = 30.0
"""deg or mm of a joint over the whole test."""

_AXES: Final[dict[str, Vector]] = {"X": (1.0, 0.0, 0.0), "Y": (0.0, 1.0, 0.0), "Z": (0.0, 0.0, 1.0)}


class CartesianParams(CampaignParams):
    """What may be chosen for the Cartesian test."""

    poses_deg: list[Annotated[list[Degrees], Field(min_length=1)]] = Field(
        min_length=1,
        max_length=50,
        title="Poses, deg",
        description="poses P1, P2 …, each with one value per axis",
    )
    directions: list[Direction] = Field(
        ["+X", "-X", "+Y", "-Y", "+Z", "-Z"],
        min_length=1,
        title="Directions",
        description="directions of motion along the axes of the base frame",
    )
    first_mm: float = Field(
        FIRST_MM, ge=0.01, le=2.0, title="First step, mm", description="size of the first step, mm"
    )
    steps: int = Field(
        100,
        ge=5,
        le=400,
        title="Number of steps",
        description="number of steps; each is the previous one divided by 1.072267",
    )
    run_in_mm: float = Field(
        5.0,
        ge=0.5,
        le=20.0,
        title="Run-in, mm",
        description="motion in the test's direction before the test, which takes up play, mm",
    )


class ResolutionCartesian(Procedure):
    """Steps the tool along a straight line in one direction, each step from where it is measured to stand."""

    name = "resolution-cartesian"
    title = "Cartesian motion resolution"
    explanation = RESOLUTION_CARTESIAN
    needs = Needs(roles=("interferometer", "environment"), optics=("linear",))
    stage = STRAIGHT
    analyses = (EVALUATE, REPORT, DOSSIER)
    sets_up_anew = True
    live_plots = "steps"
    records = (Configuration, Move, Recorded)
    event_texts = LOSS_TEXTS
    questions = CAMPAIGN
    params_type = CartesianParams

    def plan(self, bench: Bench, params: CartesianParams) -> CampaignPlan:
        """Plan every pose and direction.

        Raises:
            PlanLimitError: a pose lies outside the limits.
            PlanError: the driver takes no straight steps, a way is not clear, the arm cannot make it, or a pose is
                singular or of another arm.
        """
        if not bench.arm.steps:
            raise PlanError(
                "the robot's driver takes no straight steps: the Cartesian test needs a controller that adds "
                "increments itself"
            )
        poses = {
            f"P{number}": _pose(bench, f"P{number}", values)
            for number, values in enumerate(params.poses_deg, 1)
        }
        places = [
            _place(bench, params, pose, name, axis, chosen)
            for name, pose in poses.items()
            for axis, chosen in _by_axis(params.directions)
        ]
        return campaign(bench, params, places)

    async def run(self, ctx: Context, plan: CampaignPlan) -> None:
        """Set up, record, go on; see `carry_out`."""
        await carry_out(ctx, plan)


def _pose(bench: Bench, name: str, values: Sequence[float]) -> Pose:
    try:
        return pose_of(bench.arm.axes, values)
    except ValueError as error:
        raise PlanError(f"poses_deg, {name}: {error}; give one value for each axis") from error


def _by_axis(directions: Sequence[Direction]) -> list[tuple[str, list[Direction]]]:
    """Return each axis with its directions: optics are set up once for both."""
    found = [(axis, [one for one in dict.fromkeys(directions) if one.endswith(axis)]) for axis in _AXES]
    return [(axis, chosen) for axis, chosen in found if chosen]


def _place(
    bench: Bench, params: CartesianParams, pose: Pose, name: str, axis: str, directions: Sequence[Direction]
) -> Place:
    series = tuple(_series(bench, params, pose, name, direction) for direction in directions)
    offsets = [by for one in series for by in _offsets(params, one)]
    ends = tuple(_shifted(bench, pose, axis, sign * reach(offsets, sign)) for sign in SIGNS)
    for end in ends:
        _require_regular(bench, f"{name}, along {axis}", pose, end)
    return Place(axis, name, pose, None, "mm", "linear", (*ends, pose), series)


def _offsets(params: CartesianParams, series: Series) -> tuple[float, float]:
    """Return where a series begins its run-in, and where all its steps lead, mm from the place."""
    return -series.direction * params.run_in_mm, sum(order.command for order in series.orders)


def _require_regular(bench: Bench, where: str, pose: Pose, end: Pose) -> None:
    """Refuse a pose at which a small shift of the tool turns a joint far: a controller stops there, or whirls.

    Raises:
        PlanError: names pose, direction and joint.
    """
    changes = {axis.name: abs(to - at) for axis, at, to in zip(bench.arm.axes, pose, end, strict=True)}
    most = max(changes, key=changes.__getitem__)
    if changes[most] > _MOST_CHANGE:
        raise PlanError(
            f"{where}: the test would turn {most} by {changes[most]:.0f}° for a few mm of the tool: the pose is "
            "near a singular one; leave the direction out, or choose another pose"
        )


def _series(bench: Bench, params: CartesianParams, pose: Pose, name: str, direction: Direction) -> Series:
    sign, axis = (1 if direction[0] == "+" else -1), direction[1]
    sizes = decaying(params.first_mm, params.steps, (bench.arm.command_resolution or {}).get("mm"))
    return Series(
        f"{axis}/{name}/{SIGNS[sign]}",
        f"{direction} at {name}",
        "cartesian",
        sign,
        (_shifted(bench, pose, axis, -sign * params.run_in_mm), pose),
        tuple(Order(1, sign * size) for size in sizes),
        along=_AXES[axis],
    )


def _shifted(bench: Bench, pose: Pose, axis: str, by_mm: float) -> Pose:
    x, y, z = _AXES[axis]
    return line_target(bench, pose, (by_mm * x, by_mm * y, by_mm * z))
