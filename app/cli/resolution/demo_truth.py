"""The least steps that a demonstration has found against those of the emulated arm itself."""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np

from catseye.app.results.document import Document
from catseye.app.results.model import Block, Column, Section, Sign, Statement, Table, section
from catseye.app.results.resolution.naming import STEP, least_step_text, with_unit
from catseye.app.results.resolution.result import AnyTest, ResolutionResult
from catseye.calibration.core.types import Floats
from catseye.calibration.resolution.least_step import moving_mean, steps_within
from catseye.simulators.config import EmulationConfig, SerialArm, TruthText
from catseye.simulators.world.serial.repeated_steps import RepeatedSteps
from catseye.simulators.world.serial.true_arm import true_serial_arm
from catseye.simulators.world.serial.truth import ArmTruth

_REPEATS: Final = 200
"""Of every step: the least step of their mean is what one test is to find."""

_SEED: Final = 1


class TrueLeastStep(Document):
    """A measured least step of a joint beside that of its drivetrain; null where there is none.

    Attributes:
        joint: its name.
        direction: of the steps.
        measured: with its 95 % interval, as a text.
        measured_deg: its value.
        true_deg: of the mean of many repeats without an instrument.
        inside: the interval holds the true one.
    """

    joint: str
    direction: int
    measured: str
    measured_deg: float | None
    true_deg: float | None
    inside: bool | None


class ResolutionDemo(Document):
    """The day of motion resolution on an emulated bench.

    Attributes:
        runs: folders, in the order in which they were measured.
        result_file: what they come to.
        shipped: file with the tests that come with the program.
        report: the page.
        truth: file with the drivetrains of the emulated arm.
        least_steps: what was found against them.
        result: the result without its recordings.
    """

    runs: list[str]
    result_file: str
    shipped: str
    report: str
    truth: str
    least_steps: list[TrueLeastStep]
    result: ResolutionResult


def compare_with_truth(
    tests: Iterable[AnyTest], configurations: Iterable[Mapping[str, Any]], arm: SerialArm, truth_file: Path
) -> list[TrueLeastStep]:
    """Return the decaying tests of joints beside what their drivetrains do in the mean of many repeats.

    Args:
        tests: of the emulated arm.
        configurations: rows of the table that says how the arm stood during each series.
        truth_file: drivetrains as the emulator told them.

    Raises:
        TruthFileError: they are of another arm.
    """
    truth = true_serial_arm(arm, EmulationConfig(truth=TruthText(truth_file.read_bytes(), str(truth_file))))
    rows = {(row["joint"], row["direction"]): row for row in configurations if row["test"] == "decaying"}
    return [
        _compared(test, _true_least_step(test, rows[test.joint, test.direction], truth.arm, truth.drives))
        for test in tests
        if test.test == "decaying"
    ]


def _true_least_step(test: AnyTest, row: Mapping[str, Any], arm: SerialArm, truth: ArmTruth) -> float | None:
    number = [joint.name for joint in arm.joints].index(test.joint)
    pose: Floats = np.array(row["pose"], dtype=np.float64)
    copies = RepeatedSteps(arm, truth.joints[number], number, pose, _REPEATS, _SEED)
    sizes_deg: Floats = np.abs([move.command for move in test.moves])
    errors_percent = copies.mean_errors_percent(sizes_deg, row["direction"], row["dwell_s"])
    within = int(steps_within(moving_mean(errors_percent), test.threshold_percent))
    return float(sizes_deg[within - 1]) if within else None


def _compared(test: AnyTest, true_deg: float | None) -> TrueLeastStep:
    lis = test.lis
    return TrueLeastStep(
        joint=test.joint,
        direction=test.direction or 0,
        measured=least_step_text(test),
        measured_deg=None if lis is None else lis.value,
        true_deg=true_deg,
        inside=None if lis is None or true_deg is None else lis.low <= true_deg <= lis.high,
    )


def truth_section(compared: Sequence[TrueLeastStep]) -> Section:
    """Return measured least steps beside those of the emulated arm, for its report."""
    columns = (
        Column("test", "joint, direction"),
        Column("measured", "measured (95 %)"),
        Column("true_deg", "emulated arm"),
        Column("inside", "in the interval"),
    )
    answers = {True: "yes", False: "no", None: None}
    rows = tuple(
        (
            f"{one.joint}{'+' if one.direction > 0 else '−'}",
            one.measured,
            with_unit(one.true_deg, "deg", STEP),
            answers[one.inside],
        )
        for one in compared
    )
    inside = sum(one.inside is True for one in compared)
    text = (
        f"{inside} of {len(compared)} intervals hold the least step of the emulated arm: the paper's rule on the "
        f"mean of {_REPEATS} repeats of each step, without an interferometer and its noise"
    )
    blocks: list[Block] = [
        Statement(Sign.GOOD if inside == len(compared) else Sign.ATTENTION, text),
        Table("truth", "Least steps against the emulated arm", columns, rows),
    ]
    return section("truth", "Against the emulated arm", blocks, brief=True)
