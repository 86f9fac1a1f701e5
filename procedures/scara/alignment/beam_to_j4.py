"""The beam through the J4 axis: small turns of J4 give its offset, a stage removes it (Remark 2)."""

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import chain

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from catseye.calibration.scara.alignment import OffsetFit, fit_offset
from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.beam.settled import Unsettled, settled_measurement
from catseye.procedures.kit.context import Context, Measurement
from catseye.procedures.kit.errors import (
    AlignmentError,
    BeamLostError,
    NoBeamError,
    PlanError,
    PlanLimitError,
)
from catseye.procedures.kit.motion.clear_way import require_clear_way
from catseye.procedures.kit.needs import Needs
from catseye.procedures.kit.procedure import Procedure
from catseye.procedures.kit.records import Row
from catseye.procedures.kit.stored import number_of
from catseye.procedures.scara.alignment.screws import GuidedScrew, Screw, ScrewRounds
from catseye.procedures.scara.beam.beam_scan import ReturnWindow, find_return, half_window_deg, signal_live
from catseye.procedures.scara.before import ALIGNING, COUNTER, LEVELLED, REFLECTORS, TURNED
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.explained import BEAM_TO_J4
from catseye.procedures.scara.questions import SCREWS
from catseye.procedures.scara.records import AlignmentRound, ScrewTurn
from catseye.procedures.scara.search.search_plan import SearchPose, looking_poses

_WINDOW_SHARE = 0.8
"""J4 is turned over this share of the return window, so that the count does not break at its edges."""

_ROUGH_MM = 30.0
"""What a rough place, and so a distance, may be wrong by; the pose keeps this much more than the shortest beam."""

_NARROW = 0.4
"""Share of the full window's width that a beam just inside of the acceptance still has."""

_TRIES = 3
"""So often the turns begin anew when the beam is lost during them."""


class BeamToJ4Params(BaseModel):
    """What may be chosen for the alignment of the beam to the J4 axis."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    reflector: str = Field(
        "",
        title="Reflector",
        description="name of the reflector to aim at; empty: the one that the arm gets closest to",
    )
    theta1_deg: float | None = Field(
        None,
        ge=-360.0,
        le=360.0,
        title="J1 of the pose, deg",
        description="J1 of the pose at which the offset is measured, deg; left out: chosen by the program",
    )
    theta2_deg: float | None = Field(
        None,
        ge=-360.0,
        le=360.0,
        title="J2 of the pose, deg",
        description="J2 of the pose at which the offset is measured, deg; left out: chosen by the program",
    )
    turns: int = Field(
        21,
        ge=7,
        le=401,
        title="Positions of J4",
        description="number of positions of J4 in the window in which the beam returns",
    )
    passes: int = Field(
        2,
        ge=1,
        le=20,
        title="Passes",
        description="how often J4 goes through these positions, alternately up and down",
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
class BeamToJ4Plan:
    """From where and how the offset is measured.

    Attributes:
        bench: what it was made from.
        pose: where the arm stands.
        params: what was chosen.
    """

    bench: ScaraBench
    pose: SearchPose
    params: BeamToJ4Params

    @property
    def offsets(self) -> tuple[tuple[float, ...], ...]:
        """J4 positions of each pass as shares of half the return window, -1...1."""
        up = np.linspace(-_WINDOW_SHARE, _WINDOW_SHARE, self.params.turns)
        return tuple(
            tuple((up if number % 2 == 0 else up[::-1]).tolist()) for number in range(self.params.passes)
        )


class BeamToJ4(Procedure):
    """Measures how far the beam passes the J4 axis and guides the screw of the stage until it does not."""

    name = "beam-to-j4"
    title = "Alignment of the beam to the J4 axis"
    explanation = BEAM_TO_J4
    needs = Needs(ScaraBench, COUNTER, equipment=(REFLECTORS,), after=(LEVELLED,), aftermath=TURNED)
    stage = ALIGNING
    records = (AlignmentRound, ScrewTurn)
    questions = SCREWS
    params_type = BeamToJ4Params

    def plan(self, bench: ScaraBench, params: BeamToJ4Params) -> BeamToJ4Plan:
        """Choose the pose: the nearest one has the widest window of J4 and the steepest slope.

        Raises:
            PlanError: no such reflector, or it is not seen alone from there.
        """
        return BeamToJ4Plan(bench, _pose(bench, params), params)

    async def run(self, ctx: Context, plan: BeamToJ4Plan) -> None:
        """Measure and instruct until the offset is within its tolerance.

        Args:
            plan: what plan() returned.

        Raises:
            AlignmentError: the offset did not come within its tolerance.
            BeamLostError: the reflector does not return the beam, or not lastingly.
        """
        guided = centring(ctx, plan)
        row = await guided.align()
        await ctx.step(
            "result", "offset of the beam from the J4 axis", lambda: _result(ctx, guided.turned, row)
        )


def centring(ctx: Context, plan: BeamToJ4Plan, *, alone: bool = True) -> GuidedScrew:
    """Return what measures the offset and guides the screw; see `GuidedScrew`."""
    return GuidedScrew(ctx, stage_screw(plan.bench), _Rounds(ctx, plan), plan.params.max_rounds, alone=alone)


def stage_screw(bench: ScaraBench) -> Screw:
    """Return the screw of the lateral stage as the cell file describes it."""
    alignment = bench.alignment
    sense = 1.0 if alignment.stage_clockwise == "+y" else -1.0
    return Screw(
        name="stage",
        label="move the stage",
        quantity="offset of the beam from the J4 axis",
        unit="mm",
        per_turn=sense * alignment.stage_mm_per_turn,
        plus="towards +y",
        minus="towards −y",
        sense_key="stage_clockwise",
        sense_values=("+y", "-y"),
        pitch_key="stage_mm_per_turn",
        tolerance=alignment.offset_tolerance_mm,
    )


def _pose(bench: ScaraBench, params: BeamToJ4Params) -> SearchPose:
    given = (params.theta1_deg, params.theta2_deg)
    if (given[0] is None) != (given[1] is None):
        raise PlanError(
            "a pose needs both theta1_deg and theta2_deg: give the other one too, or none of them"
        )
    at = None if given[0] is None or given[1] is None else (given[0], given[1])
    reflectors = bench.chosen((params.reflector,) if params.reflector else ())
    seen = list(
        chain.from_iterable(
            looking_poses(bench, reflector, params.half_range_deg, at) for reflector in reflectors
        )
    )
    usable = [pose for pose in seen if pose.beam_mm >= bench.optics.beam_min_mm + _ROUGH_MM]
    if not usable:
        names = ", ".join(reflector.name for reflector in reflectors)
        where = "any pose" if at is None else f"θ1 = {at[0]:g}°, θ2 = {at[1]:g}°"
        raise PlanError(
            f"{names} cannot be seen alone from {where} at {bench.optics.beam_min_mm + _ROUGH_MM:g} mm or more with "
            f"J4 turning by ±{params.half_range_deg:g}°: choose another reflector or pose, or lower half_range_deg"
        )
    require_inside(bench, [(pose.theta1_deg, pose.theta2_deg) for pose in usable])
    nearest = min(usable, key=lambda pose: pose.beam_mm)
    require_clear_way(nearest.turned(params.half_range_deg, bench), bench)
    return nearest


def require_inside(bench: ScaraBench, poses_deg: Sequence[tuple[float, float]]) -> None:
    """Check poses against the limits of J1 and J2.

    Raises:
        PlanLimitError: names joint, angle and limits.
    """
    named = (("J1", bench.j1_limits_deg), ("J2", bench.j2_limits_deg))
    for pose in poses_deg:
        for value, (name, (low, high)) in zip(pose, named, strict=True):
            if not low <= value <= high:
                raise PlanLimitError(
                    f"{name} = {value:g}° is outside {low:g}°…{high:g}°: choose another pose"
                )


class _Rounds(ScrewRounds):
    """Measures the offset; knows where the beam was centred last."""

    def __init__(self, ctx: Context, plan: BeamToJ4Plan) -> None:
        super().__init__(ctx, plan.bench)
        self._plan = plan

    @property
    def start(self) -> Pose:
        """Where each round begins."""
        return self._at(self._plan.pose.j4_deg)

    async def measure(self, number: int, expected: float | None, last: Row | None) -> Row:
        """Find the return window, turn J4 through it and fit."""
        plan = self._plan
        await self._begin(plan.pose.reflector)
        window = await self._window(expected, last)
        taken: list[tuple[int, Measurement]] | None = None
        for attempt in range(_TRIES):
            with suppress(NoBeamError):
                taken = await self._turns(window, f"stage/{number}/{attempt}")
            if taken is not None:
                self._require_enough(taken)
                fit = _fit(taken, window.centre_deg)
                await self._doubt(fit)
                return {**self._row(fit, window), **_lengths(taken, window.centre_deg)}
        raise BeamLostError(
            f"the beam was lost {_TRIES} times while J4 turned through the middle {_WINDOW_SHARE:.0%} of the return "
            f"window of {plan.pose.reflector.name}: keep it free, and check whether acceptance_mm is right"
        )

    def _require_enough(self, taken: list[tuple[int, Measurement]]) -> None:
        wanted, least = self._plan.params, self._bench.optics.signal_min
        asked = wanted.turns * wanted.passes
        if 2 * len(taken) < asked:
            raise AlignmentError(
                f"only {len(taken)} of {asked} distances have settled with a signal of {least:g} or more: "
                "clean and face the reflector, look for what shakes it, or lower signal_min in [optics]"
            )

    async def _window(self, expected: float | None, last: Row | None) -> ReturnWindow:
        """Search the window: near where it has to be after the last turn, then everywhere."""
        plan, optics = self._plan, self._bench.optics
        pose, half_window = plan.pose, half_window_deg(optics.acceptance_mm, plan.pose.beam_mm)
        everywhere = (pose.j4_deg, plan.params.half_range_deg)
        # A beam that is too high or too low has a narrower window, between the steps of the first scan.
        scans = [(*everywhere, half_window), (*everywhere, _NARROW * half_window)]
        if last is not None:
            # An offset that grows by c turns the aim by −c / D.
            shift_deg = -math.degrees((expected or 0.0) / pose.beam_mm)
            near_deg = 3.0 * half_window + 2.5 * abs(shift_deg)
            scans.insert(0, (number_of(last, "j4_deg") + shift_deg, near_deg, half_window))
        for j4_deg, half_range, stride in scans:
            start = (pose.theta1_deg, pose.theta2_deg, plan.bench.j3_mm, j4_deg)
            limits = plan.bench.j4_limits_deg
            window = await find_return(self._ctx, start, half_range, stride, limits, optics.signal_min)
            if window is not None:
                return window
        raise BeamLostError(
            f"reflector {pose.reflector.name} does not return the beam within ±{plan.params.half_range_deg:g}° of "
            f"J4 = {pose.j4_deg:.2f}° at θ1 = {pose.theta1_deg:g}°, θ2 = {pose.theta2_deg:g}°: check that the beam "
            "is level and at this height (beam-level gives j3_mm) and free, the rough place and theta40_deg, or "
            "raise half_range_deg"
        )

    async def _turns(self, window: ReturnWindow, where: str) -> list[tuple[int, Measurement]] | None:
        """Measure all passes on one count; None when the count was broken."""
        plan, centre_deg = self._plan, window.centre_deg
        half_deg = 0.5 * (window.upper_deg - window.lower_deg)
        await self._ctx.move(self._at(centre_deg))
        await self._ctx.zero(plan.pose.beam_mm)
        taken = []
        for number, shares in enumerate(plan.offsets):
            for position, share in enumerate(shares):
                await self._ctx.move(self._at(centre_deg + share * half_deg))
                name = f"{where}/{number}/{position}"
                measured = await settled_measurement(self._ctx, plan.bench.timing, name)
                if isinstance(measured, Unsettled):
                    continue
                self._ctx.show(signal_live(measured.beam.signal, plan.bench.optics.signal_min))
                if not measured.beam.count_valid:
                    return None
                # Too weak a return is no distance, but it keeps the count.
                if measured.beam.signal >= plan.bench.optics.signal_min:
                    taken.append((number, measured))
        return taken

    def _at(self, j4_deg: float) -> Pose:
        pose = self._plan.pose
        return (pose.theta1_deg, pose.theta2_deg, self._bench.j3_mm, j4_deg)

    async def _doubt(self, fit: OffsetFit) -> None:
        beam_mm = self._plan.pose.beam_mm
        if not fit.plausible_at(beam_mm, _ROUGH_MM):
            await self._ctx.warn(
                f"the length bends by {fit.curvature_mm:.0f} mm/rad² over the turns of J4 and a beam of "
                f"{beam_mm:.0f} mm has to bend by {-0.5 * beam_mm:.0f} mm/rad²: something else moves; check that the "
                "reflector and the interferometer are fastened, and that the rough place is right"
            )

    def _row(self, fit: OffsetFit, window: ReturnWindow) -> Row:
        return {
            "value": fit.offset_mm,
            "u": math.hypot(fit.u_mm, _u_radial_mm(self._bench)),
            "u_repeat": fit.u_mm,
            "j4_deg": window.centre_deg,
            "window_deg": window.upper_deg - window.lower_deg,
            "signal": window.signal,
            "distance_mm": self._plan.pose.beam_mm,
            "curvature_mm": fit.curvature_mm,
            "rms_um": fit.rms_mm * 1e3,
        }


def _fit(taken: list[tuple[int, Measurement]], centre_deg: float) -> OffsetFit:
    turn = np.deg2rad([measured.reported[3] - centre_deg for _, measured in taken])
    length = np.array([measured.displacement_mm for _, measured in taken])
    series = np.array([number for number, _ in taken], dtype=np.int64)
    variances = [measured.spread_mm**2 / measured.readings for _, measured in taken]
    return fit_offset(turn, length, series, math.sqrt(math.fsum(variances) / max(len(variances), 1)))


def _lengths(taken: list[tuple[int, Measurement]], centre_deg: float) -> Row:
    """Return the lengths that were fitted, as a step keeps them."""
    return {
        "turn_deg": [measured.reported[3] - centre_deg for _, measured in taken],
        "length_mm": [measured.displacement_mm for _, measured in taken],
        "series": [number for number, _ in taken],
    }


def _u_radial_mm(bench: ScaraBench) -> float:
    """Return the rms slope of J4's radial error motion, mm/rad: it looks like an offset and no turn removes it."""
    orders = np.arange(1, bench.noise.radial_orders + 1)
    return float(bench.noise.radial_mm[2] * np.sqrt(np.mean(orders**2)))


async def _result(ctx: Context, turned: bool, row: Row) -> Row:
    if turned:
        await ctx.warn(
            "the beam was moved: places and θ40 of earlier searches are no longer valid; run reflector-search again"
        )
    return {
        "offset_mm": row["value"],
        "u_mm": row["u"],
        "j4_deg": row["j4_deg"],
        "distance_mm": row["distance_mm"],
    }
