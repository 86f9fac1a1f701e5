"""The beam parallel to the XY plane: heights of J3 at which it meets a reflector from near and far give its pitch."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from catseye.calibration.scara.alignment import PitchFit, fit_pitch
from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.context import Context
from catseye.procedures.kit.errors import AlignmentError, BeamLostError, PlanError
from catseye.procedures.kit.motion.clear_way import way_refusal
from catseye.procedures.kit.needs import Needs
from catseye.procedures.kit.procedure import Procedure
from catseye.procedures.kit.records import Row
from catseye.procedures.kit.stored import numbers_of
from catseye.procedures.scara import texts
from catseye.procedures.scara.alignment.screws import GuidedScrew, Screw, ScrewRounds
from catseye.procedures.scara.beam.beam_scan import find_at_heights, find_height, half_window_deg
from catseye.procedures.scara.before import COUNTER, LEVELLING, REFLECTORS, TURNED
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.explained import BEAM_LEVEL
from catseye.procedures.scara.questions import SCREWS
from catseye.procedures.scara.records import AlignmentRound, ScrewTurn
from catseye.procedures.scara.search.search_plan import SearchPose, looking_poses, measured_distances_mm

_ROUGH_MM = 30.0
"""What a rough place may be wrong by; the poses keep this much more than the shortest beam."""

_NEAR_MM = 200.0
"""Nearer than this the rough place leaves too much doubt about the direction."""

_LEAST_BASE_MM = 100.0
"""Distances have to differ by this much to determine a pitch."""

U_HEIGHT_MM = 0.01
"""The middle of a return window in height: resolution of its edges and of J3."""


class BeamLevelParams(BaseModel):
    """What may be chosen for the levelling of the beam."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    reflector: str = Field(
        "",
        title="Reflector",
        description="name of the reflector to aim at; empty: the one with the widest range of distances",
    )
    poses: int = Field(
        3, ge=2, le=6, title="Distances", description="number of distances at which the height is measured"
    )
    max_rounds: int = Field(
        8,
        ge=2,
        le=50,
        title="Rounds at most",
        description="number of measurements after which the alignment is given up",
    )
    half_range_deg: float = Field(
        15.0,
        gt=0.0,
        le=45.0,
        title="First scan ±, deg",
        description="range of the first scan of J4, to either side of the expected direction, deg",
    )


@dataclass(frozen=True)
class BeamLevelPlan:
    """From where the heights are measured.

    Attributes:
        bench: what it was made from.
        poses: from near to far.
        j3_range_mm: where J3 may go.
        distances_mm: shortest and longest beam of the measurement that is to come.
        params: what was chosen.
    """

    bench: ScaraBench
    poses: tuple[SearchPose, ...]
    j3_range_mm: tuple[float, float]
    distances_mm: tuple[float, float]
    params: BeamLevelParams


class BeamLevel(Procedure):
    """Measures the beam's pitch and guides the vertical screw until the beam is level."""

    name = "beam-level"
    title = "Levelling of the beam"
    explanation = BEAM_LEVEL
    needs = Needs(ScaraBench, COUNTER, equipment=(REFLECTORS,), aftermath=TURNED)
    stage = LEVELLING
    records = (AlignmentRound, ScrewTurn)
    event_texts = texts.HEIGHT
    questions = SCREWS
    params_type = BeamLevelParams

    def __init__(self) -> None:
        self._away_from_mm: float | None = None

    def plan(self, bench: ScaraBench, params: BeamLevelParams) -> BeamLevelPlan:
        """Choose poses at different distances to one reflector.

        Raises:
            PlanError: J3 has no range, or the reflector is not seen from different enough distances.
        """
        if bench.j3_range_mm is None:
            raise PlanError(
                "levelling moves J3, and the cell file states no range for it: set j3_range_mm in [robot] to "
                f"heights that are free at every pose, for instance j3_range_mm = [{bench.j3_mm - 10:g}, "
                f"{bench.j3_mm + 10:g}]"
            )
        poses = _poses(bench, params)
        return BeamLevelPlan(bench, poses, bench.j3_range_mm, measured_distances_mm(bench), params)

    async def run(self, ctx: Context, plan: BeamLevelPlan) -> None:
        """Measure and instruct until the pitch is within its tolerance.

        Args:
            plan: what plan() returned.

        Raises:
            AlignmentError: the pitch did not come within its tolerance, or J3's range is too small.
            BeamLostError: the reflector does not return the beam.
        """
        self._away_from_mm = plan.bench.j3_mm
        row = await levelling(ctx, plan).align()
        await ctx.step("result", "height at which everything is measured", lambda: _result(ctx, plan, row))
        await ctx.step("height", "J3 back at the height of the cell file", lambda: _back(ctx, plan))
        self._away_from_mm = None

    async def teardown(self, ctx: Context) -> None:
        """Leave the arm where it stands, and say so when J3 was not brought back."""
        if self._away_from_mm is not None:
            await ctx.warn(
                f"levelling has left J3 at another height than j3_mm = {self._away_from_mm:g}: the next procedure "
                "brings it there first, or move it yourself"
            )


async def _back(ctx: Context, plan: BeamLevelPlan) -> Row:
    one, two, _, four = await ctx.joints()
    await ctx.move((one, two, plan.bench.j3_mm, four))
    return {"j3_mm": plan.bench.j3_mm}


def levelling(ctx: Context, plan: BeamLevelPlan, *, alone: bool = True) -> GuidedScrew:
    """Return what measures the pitch and guides the screw; see `GuidedScrew`."""
    return GuidedScrew(ctx, level_screw(plan.bench), _Rounds(ctx, plan), plan.params.max_rounds, alone=alone)


def fitted_height(row: Row) -> PitchFit:
    """Return pitch and height of the beam as a round has found them."""
    return fit_pitch(
        np.array(numbers_of(row, "distance_mm")), np.array(numbers_of(row, "j3_mm")), U_HEIGHT_MM
    )


def level_screw(bench: ScaraBench) -> Screw:
    """Return the vertical screw as the cell file describes it."""
    alignment = bench.alignment
    sense = 1.0 if alignment.level_clockwise == "up" else -1.0
    return Screw(
        name="level",
        label="tilt the beam",
        quantity="pitch of the beam",
        unit="mrad",
        per_turn=sense * alignment.level_mrad_per_turn,
        plus="up",
        minus="down",
        sense_key="level_clockwise",
        sense_values=("up", "down"),
        pitch_key="level_mrad_per_turn",
        tolerance=alignment.level_tolerance_mrad,
    )


def _poses(bench: ScaraBench, params: BeamLevelParams) -> tuple[SearchPose, ...]:
    reflectors = bench.chosen((params.reflector,) if params.reflector else ())
    chains = [
        _spaced(
            looking_poses(bench, reflector, params.half_range_deg), params.half_range_deg, bench, params.poses
        )
        for reflector in reflectors
    ]
    best = max(chains, key=_base_mm, default=())
    if _base_mm(best) < _LEAST_BASE_MM:
        names = ", ".join(reflector.name for reflector in reflectors)
        raise PlanError(
            f"{names} cannot be seen alone from {params.poses} distances that lie {_LEAST_BASE_MM:g} mm or more "
            f"apart, with J4 turning by ±{params.half_range_deg:g}° and a free way between: choose another "
            "reflector, or lower half_range_deg"
        )
    return best


def _base_mm(poses: Sequence[SearchPose]) -> float:
    return poses[-1].beam_mm - poses[0].beam_mm if poses else 0.0


def _spaced(
    seen: Sequence[SearchPose], half_range_deg: float, bench: ScaraBench, count: int
) -> tuple[SearchPose, ...]:
    """Return poses from near to far whose distances are spread evenly and whose ways are free."""
    least = max(_NEAR_MM, bench.optics.beam_min_mm + _ROUGH_MM)
    usable = sorted((pose for pose in seen if pose.beam_mm >= least), key=lambda pose: pose.beam_mm)
    if not usable:
        return ()
    chosen = [usable[0]]
    for wanted in np.linspace(usable[0].beam_mm, usable[-1].beam_mm, count)[1:]:
        farther = [pose for pose in usable if pose.beam_mm > chosen[-1].beam_mm]
        farther.sort(key=lambda pose: abs(pose.beam_mm - wanted))
        # After the farthest one the arm returns to the nearest.
        free = (pose for pose in farther if _free((chosen[-1], pose, chosen[0]), half_range_deg, bench))
        following = next(free, None)
        if following is None:
            return ()
        chosen.append(following)
    return tuple(chosen)


def _free(poses: Sequence[SearchPose], half_range_deg: float, bench: ScaraBench) -> bool:
    """Return whether ways between poses are clear, with J4 and J3 anywhere in the ranges that are scanned."""
    heights = bench.j3_range_mm or (bench.j3_mm,)
    way: list[Pose] = []
    for pose in poses:
        ends = pose.turned(half_range_deg, bench)
        way += [(one, two, height, four) for height in heights for one, two, _, four in ends]
        way.append(ends[1])
    return way_refusal(way, bench) is None


@dataclass(frozen=True)
class _Found:
    """Where the beam meets the reflector from one pose.

    Attributes:
        j4_deg: middle of the return in J4.
        j3_mm: middle of the return in height.
    """

    j4_deg: float
    j3_mm: float


class _Rounds(ScrewRounds):
    """Measures the pitch; knows where the beam came back from each pose in the last round."""

    def __init__(self, ctx: Context, plan: BeamLevelPlan) -> None:
        super().__init__(ctx, plan.bench)
        self._plan = plan

    @property
    def start(self) -> Pose:
        """Where each round begins."""
        first = self._plan.poses[0]
        return (first.theta1_deg, first.theta2_deg, self._bench.j3_mm, first.j4_deg)

    async def measure(self, number: int, expected: float | None, last: Row | None) -> Row:
        """Find the heights from near to far and fit the pitch."""
        del number
        poses = self._plan.poses
        await self._begin(poses[0].reflector)
        found: list[_Found] = []
        for place, pose in enumerate(poses):
            before = (
                None
                if last is None
                else _Found(numbers_of(last, "j4_deg")[place], numbers_of(last, "j3_mm")[place])
            )
            found.append(await self._find(pose, found, before, expected or 0.0))
        fit = self._fit(found)
        return {
            "value": fit.pitch_rad * 1e3,
            "u": fit.u_pitch_rad * 1e3,
            "u_repeat": fit.u_pitch_rad * 1e3,
            "distance_mm": [pose.beam_mm for pose in poses],
            "j3_mm": [place.j3_mm for place in found],
            "j4_deg": [place.j4_deg for place in found],
            "axis_height_mm": fit.axis_height_mm,
        }

    def _fit(self, found: Sequence[_Found]) -> PitchFit:
        distance = np.array([pose.beam_mm for pose in self._plan.poses[: len(found)]])
        return fit_pitch(distance, np.array([place.j3_mm for place in found]), U_HEIGHT_MM)

    async def _find(
        self, pose: SearchPose, nearer: list[_Found], before: _Found | None, change_mrad: float
    ) -> _Found:
        """Find the return from a pose in J4 and in height, from the likeliest height outwards."""
        low, high = self._plan.j3_range_mm
        around_deg, half_range_deg = self._direction(pose, nearer, before)
        likely = min(max(self._likely_mm(pose, nearer, before, change_mrad), low), high)
        start = (pose.theta1_deg, pose.theta2_deg, likely, around_deg)
        at = await find_at_heights(self._ctx, start, half_range_deg, pose.beam_mm, self._bench, (low, high))
        if at is not None:
            return await self._centred(pose, at)
        raise BeamLostError(
            f"reflector {pose.reflector.name} does not return the beam at θ1 = {pose.theta1_deg:g}°, "
            f"θ2 = {pose.theta2_deg:g}° ({pose.beam_mm:.0f} mm away) at any height of J3 from {low:g} to {high:g} "
            "mm: check that the beam is free, the rough place, theta40_deg and j3_range_mm, "
            "turn the level screw back if it was turned the wrong way, or raise half_range_deg"
        )

    def _direction(
        self, pose: SearchPose, nearer: list[_Found], before: _Found | None
    ) -> tuple[float, float]:
        """Return J4 and how far to scan about it."""
        full_deg = self._plan.params.half_range_deg
        if before is not None:
            window = half_window_deg(self._bench.optics.acceptance_mm, pose.beam_mm)
            return before.j4_deg, min(full_deg, 3.0 * window)
        if not nearer:
            return pose.j4_deg, full_deg
        first = self._plan.poses[0]
        doubt_deg = float(np.rad2deg(_ROUGH_MM * (1.0 / first.beam_mm + 1.0 / pose.beam_mm)))
        return pose.j4_deg + nearer[0].j4_deg - first.j4_deg, min(full_deg, doubt_deg)

    def _likely_mm(
        self, pose: SearchPose, nearer: list[_Found], before: _Found | None, change_mrad: float
    ) -> float:
        """Return the height to begin with."""
        if before is not None:
            return before.j3_mm - change_mrad * 1e-3 * pose.beam_mm
        if len(nearer) > 1:
            return self._fit(nearer).height_mm(pose.beam_mm)
        return nearer[0].j3_mm if nearer else self._bench.j3_mm

    async def _centred(self, pose: SearchPose, at: Pose) -> _Found:
        optics, (low, high) = self._bench.optics, self._plan.j3_range_mm
        window = await find_height(self._ctx, at, 0.0, optics.acceptance_mm, (low, high), optics.signal_min)
        if window is None:
            raise BeamLostError(
                f"the beam to reflector {pose.reflector.name} was lost while J3 stood at {at[2]:.2f} mm: keep it free"
            )
        if isinstance(window, str):
            end = f"below {low:g} mm" if window == "lower" else f"above {high:g} mm"
            raise AlignmentError(
                f"the beam still returns from reflector {pose.reflector.name} {end}, the {window} end of J3's range: "
                "its middle cannot be known; widen j3_range_mm in [robot], or set mount or reflector higher or lower"
            )
        return _Found(at[3], window.centre_mm)


async def _result(ctx: Context, plan: BeamLevelPlan, row: Row) -> Row:
    fit = fitted_height(row)
    nearest, farthest = plan.distances_mm
    middle_mm = 0.5 * (nearest + farthest)
    j3_mm = round(fit.height_mm(middle_mm), 2)
    left_mm = abs(fit.pitch_rad) * 0.5 * (farthest - nearest)
    advice = (
        f"set j3_mm = {j3_mm:g} in [robot]: there the beam meets the reflectors' height over beams of {nearest:.0f} "
        f"to {farthest:.0f} mm within {left_mm:.2f} mm; the cell file has {plan.bench.j3_mm:g}"
    )
    await ctx.event("height", j3_mm=j3_mm, u_j3_mm=fit.u_height_mm(middle_mm), left_mm=left_mm, text=advice)
    if abs(j3_mm - plan.bench.j3_mm) > 0.1 * plan.bench.optics.acceptance_mm:
        await ctx.warn(advice)
    return {
        "pitch_mrad": row["value"],
        "u_pitch_mrad": row["u"],
        "j3_mm": j3_mm,
        "u_j3_mm": fit.u_height_mm(middle_mm),
        "left_mm": left_mm,
    }
