"""A telescopic ballbar between a fixed cup and nests of the tool (six-axis paper, section 6.3, Table XII)."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from catseye.drivers.roles.pose import Pose, out_of_range
from catseye.procedures.kit.context import Context
from catseye.procedures.kit.errors import OutOfReachError, PlanError, PlanLimitError
from catseye.procedures.kit.motion.clear_way import require_clear_way
from catseye.procedures.kit.needs import Needs
from catseye.procedures.kit.procedure import Procedure
from catseye.procedures.serial_arm.ballbar_body import require_clear_bar
from catseye.procedures.serial_arm.ballbar_plan import BallbarPlan, BarPath
from catseye.procedures.serial_arm.ballbar_run import BallbarReading, BallbarRun
from catseye.procedures.serial_arm.before import BAR_TEXTS, SPANNING
from catseye.procedures.serial_arm.bench import Ballbar, SerialBench, ballbar_of
from catseye.procedures.serial_arm.calibrated import RESULT, calibrated, identified_target
from catseye.procedures.serial_arm.explained import BALLBAR
from catseye.procedures.serial_arm.pose_params import rest_of
from catseye.procedures.serial_arm.questions import BALLBAR_MOUNTED, LENGTHS_FILE, READING

Floats = NDArray[np.float64]

_MOST_NESTS = 4


class BallbarParams(BaseModel):
    """What may be chosen for a ballbar."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    result: Annotated[dict[str, Any], RESULT] = Field(
        title="Result file",
        description="result of catseye calibrate, which compensates the commands",
        json_schema_extra={"file": "JSON"},
    )
    nests: list[str] = Field(
        [],
        max_length=_MOST_NESTS,
        title="Nests of the tool",
        description="nests of the tool, one path for each; empty: the first two",
    )
    azimuth_deg: list[float] = Field(
        [-90.0, -30.0],
        min_length=2,
        max_length=2,
        title="Azimuth, deg",
        description="range of the bar's direction about z, deg; 0: from the cup towards the arm's base",
    )
    elevation_deg: list[float] = Field(
        [30.0, 80.0],
        min_length=2,
        max_length=2,
        title="Elevation, deg",
        description="range of the bar's angle above the horizontal, deg",
    )
    step_deg: float = Field(
        10.0,
        ge=1.0,
        le=60.0,
        title="Step, deg",
        description="angle between two positions on a ring, and between two rings, deg",
    )
    safe_mm: float = Field(
        0.8,
        gt=0.0,
        le=5.0,
        title="Bar may deviate by, mm",
        description="largest predicted deviation of the bar from its length, mm",
    )
    dwell_s: float = Field(
        2.0, ge=0.1, le=60.0, title="Standstill, s", description="wait at standstill before a reading, s"
    )
    readings: Literal["typed", "file"] = Field(
        "typed",
        title="Readings",
        description="typed: you type each one; file: they are the plateaus of a recording",
    )
    rest_deg: list[float] = Field(
        [], title="Rest pose, deg", description="pose at which the paths begin and end; empty: zeros"
    )
    centre_mm: list[float] = Field(
        [],
        max_length=3,
        title="Place of the cup, mm",
        description="position x, y, z of the cup in the arm's base frame, as found by ballbar-cup; empty: that of "
        "the cell file",
    )


class BallbarTest(Procedure):
    """Leads nests of the tool over a sphere about a fixed cup, by compensated commands only."""

    name = "ballbar"
    title = "Ballbar"
    explanation = BALLBAR
    needs = Needs(SerialBench)
    stage = SPANNING
    records = (BallbarReading,)
    event_texts = BAR_TEXTS
    questions = (BALLBAR_MOUNTED, READING, LENGTHS_FILE)
    params_type = BallbarParams

    def plan(self, bench: SerialBench, params: BallbarParams) -> BallbarPlan:
        """Plan the paths; nothing moves by commands that are not compensated.

        Raises:
            OutOfReachError: a predicted length is beyond what is safe for the bar.
            PlanError: the cell has no ballbar, the result is none of this arm, or the arm cannot go along a path.
        """
        ballbar = _about(ballbar_of(bench), params.centre_mm)
        rest = rest_of(bench, params.rest_deg)
        names = params.nests or [one.name for one in bench.targets[:2]]
        paths = tuple(_path(bench, ballbar, params, name, rest) for name in names)
        return BallbarPlan(bench, ballbar, rest, paths, params.dwell_s, params.readings)

    async def run(self, ctx: Context, plan: BallbarPlan) -> None:
        """Lead every nest over its path; see `BallbarRun`."""
        await BallbarRun(ctx, plan).run()


def _about(ballbar: Ballbar, centre_mm: list[float]) -> Ballbar:
    """Return the ballbar with its cup where a parameter says, or where the cell file does."""
    if not centre_mm:
        return ballbar
    if len(centre_mm) != 3:
        raise PlanError(f"centre_mm has {len(centre_mm)} values: give x, y and z of the cup")
    x, y, z = centre_mm
    return replace(ballbar, centre_mm=(x, y, z))


def _path(bench: SerialBench, ballbar: Ballbar, params: BallbarParams, name: str, rest: Pose) -> BarPath:
    # The solver takes its time to import: whoever lists procedures does without.
    from catseye.calibration.core.errors import CalibrationError
    from catseye.calibration.serial_arm.joint_source import require_commanded
    from catseye.procedures.serial_arm.ballbar_path import (
        PredictedPath,
        SpherePoint,
        compensated_path,
        nominal_path,
        refined_path,
        sphere_path,
    )

    number = bench.targets.index(bench.target(name))
    centre = np.array(ballbar.centre_mm)
    towards = math.degrees(math.atan2(-centre[1], -centre[0]))
    path = sphere_path(
        _steps(params.azimuth_deg, params.step_deg), _steps(params.elevation_deg, params.step_deg), towards
    )
    geometry = calibrated(bench, params.result)
    nest = identified_target(bench, geometry, name)
    try:
        require_commanded(params.result.get("joints"))

        def predicted(places: Sequence[SpherePoint]) -> PredictedPath:
            nominal = nominal_path(bench, nest, centre, ballbar.length_mm, places, rest)
            return compensated_path(geometry, number, centre, ballbar.length_mm, nominal, rest)

        path, found = refined_path(path, predicted)
    except CalibrationError as error:
        raise PlanError(f"result: {error}") from error
    limit_mm = min(params.safe_mm, ballbar.range_mm)
    if not found.largest_mm <= limit_mm:
        raise OutOfReachError(
            f"{name}: on its path the bar would differ from {ballbar.length_mm:g} mm by "
            f"{found.largest_mm:.3f} mm, more "
            f"than {limit_mm:g} mm is safe (its range is ±{ballbar.range_mm:g} mm): choose a smaller step_deg, or a "
            "better calibration"
        )
    commands = tuple(tuple(pose) for pose in found.commands.tolist())
    if wrong := [text for pose in commands for text in out_of_range(bench.arm.axes, pose)]:
        raise PlanLimitError(f"{name}: {wrong[0]}: choose smaller ranges of azimuth and elevation")
    require_clear_way((rest, *commands, rest), bench)
    require_clear_bar(bench, ballbar, nest, commands)
    measured = tuple(number for number, one in enumerate(path) if one.measured)
    return BarPath(name, commands, measured, tuple(found.deviation_mm.tolist()), found.largest_mm)


def _steps(ends_deg: list[float], step_deg: float) -> list[float]:
    low, high = ends_deg
    if not low < high:
        raise PlanError(f"a range of {low:g} … {high:g} deg is empty: give the lower end first")
    return [float(value) for value in np.linspace(low, high, max(round((high - low) / step_deg), 1) + 1)]
