"""Result JSON of motion resolution, version 1: tests of joints and Cartesian directions.

In the file the unit is part of a key's name (`lis_deg`, `lis_mm`); in Python a test states it once, as `unit`.
"""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any, Final, Literal, Self, TypeAlias

from pydantic import ConfigDict, Discriminator, Field, Tag, model_validator

from catseye.app.files.atomic import write_atomically
from catseye.app.results.provenance import Provenance
from catseye.app.results.result_file import read_result_file
from catseye.app.results.uncertainty_part import Finite, ResultPart, Uncertainty

Test: TypeAlias = Literal["decaying", "iso", "backlash", "cartesian"]
Direction: TypeAlias = Literal[1, -1]
Unit: TypeAlias = Literal["deg", "mm"]

RESOLUTION_FORMAT: Final = "catseye-resolution/1"

_WITH_UNIT: Final = frozenset(
    {"position", "command", "measured", "u", "lis", "by_rule", "reversal", "plateau"}
)


def _keys_in(unit: Unit) -> Callable[[str], str]:
    return lambda name: f"{name}_{unit}" if name in _WITH_UNIT else name


_DEG: Final = ConfigDict(alias_generator=_keys_in("deg"), populate_by_name=True)
_MM: Final = ConfigDict(alias_generator=_keys_in("mm"), populate_by_name=True)


class LeastStep(ResultPart):
    """Least increment step: the smallest commanded step from which on the error keeps within the threshold.

    Attributes:
        value: in the test's unit.
        u: standard uncertainty.
        low: lower end of the 95 % interval.
        high: upper end of it.
    """

    value: Annotated[Finite, Field(gt=0.0)]
    u: Uncertainty
    low: Finite
    high: Finite


class Reversal(ResultPart):
    """Reversal error: lost motion is positive.

    Attributes:
        value: in the test's unit.
        u: standard uncertainty; None where nothing was repeated.
        valid: the motor torque changed its sign between the directions; None where none was recorded by this clock.
    """

    value: Finite
    u: Uncertainty | None
    valid: bool | None


class _Move(ResultPart):
    """One commanded step and what came of it.

    Attributes:
        command: signed size, in the test's unit.
        measured: likewise; None where the step was not found.
        error_percent: of the command; None where it is not known.
        u: standard uncertainty of the measured size; None where it was not stated.
        mean_percent: moving mean of the errors there.
        std_percent: standard deviation of the errors about it.
        judged: the command is not below what the instrument resolves.
    """

    command: Finite
    measured: Finite | None
    error_percent: Finite | None
    u: Uncertainty | None = None
    mean_percent: Finite | None = None
    std_percent: Uncertainty | None = None
    judged: bool = True

    @model_validator(mode="after")
    def _has_a_size(self) -> Self:
        if self.command == 0.0 and self.judged and self.error_percent is not None:
            raise ValueError("a step of 0 has no error in percent")
        return self


class AngularMove(_Move):
    """In deg."""

    model_config = _DEG


class LinearMove(_Move):
    """In mm."""

    model_config = _MM


class _Staircase(ResultPart):
    """A recording, thinned out for drawing, and its plateaus.

    Attributes:
        t_s: times of some samples, s.
        position: at these times.
        plateau_t_s: middle of each plateau, s.
        plateau: mean position on each.
        plateau_s: how long each lasts, s.
    """

    t_s: list[Finite]
    position: list[Finite]
    plateau_t_s: list[Finite]
    plateau: list[Finite]
    plateau_s: Annotated[float, Field(gt=0.0, allow_inf_nan=False)]


class AngularStaircase(_Staircase):
    """In deg."""

    model_config = _DEG


class LinearStaircase(_Staircase):
    """In mm."""

    model_config = _MM


class _Target(ResultPart):
    """A position of a backlash test that was reached from both sides.

    Attributes:
        position: commanded, from where the test began.
        reversal: lost motion there, positive.
    """

    position: Finite
    reversal: Finite


class AngularTarget(_Target):
    """In deg."""

    model_config = _DEG


class LinearTarget(_Target):
    """In mm."""

    model_config = _MM


class _Amplitude(ResultPart):
    """A step size of a test by ISO 230.

    Attributes:
        command: size of the steps.
        distinguishable: each of them shows, by the objective criterion.
    """

    command: Finite
    distinguishable: bool


class AngularAmplitude(_Amplitude):
    """In deg."""

    model_config = _DEG


class LinearAmplitude(_Amplitude):
    """In mm."""

    model_config = _MM


class Torque(ResultPart):
    """Mean motor torque on the plateaus of a backlash test, N m."""

    forward_nm: Finite
    backward_nm: Finite


class Clocks(ResultPart):
    """The recording's clock against that of the moves, where they were aligned.

    Attributes:
        offset_s: what it is ahead at `about_s`, the delay between a command and the begin of its motion included, s.
        u_offset_s: standard uncertainty of the sum of both, s.
        about_s: time by the clock of the moves at which the offset holds, s.
        drift_ppm: what it gains.
        u_drift_ppm: standard uncertainty.
        peaks: steps that this comes from.
    """

    offset_s: Finite
    u_offset_s: Uncertainty
    about_s: Finite
    drift_ppm: Finite
    u_drift_ppm: Uncertainty
    peaks: int


class LikelyMistake(ResultPart):
    """What may have made all steps of a test longer.

    Attributes:
        factor: by which it makes them longer.
        text: what it is.
    """

    factor: Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
    text: str


class _Test(ResultPart):
    """One test of a joint at one position, or of a Cartesian direction.

    Attributes:
        test: which one.
        joint: name of the axis in the arm's description; X, Y or Z of a Cartesian test.
        position: of the joint, where the test was made; None where none was stated.
        position_name: what the run or the arm's description calls it, K1 … K5; None where nobody named it.
        direction: of its steps; None of a test in both directions.
        threshold_percent: largest error of a step that counts as made.
        lis: None where the test gives none.
        lis_reason: why there is none, which is one of the flags, too; None where there is one, and of other tests.
        by_rule: least step by the paper's rule on this series alone; None of other tests, and where there is none.
        likely_mistake: why no least step is stated, where the size of all steps gives it away; else None.
        reversal: None of a test that gives none.
        flags: what was noticed about the data or the result.
        doubts: those of the flags that speak against them, not those that belong to every good test.
        pose: name of the pose of a Cartesian test.
        duration_s: from the first move to the end of the last plateau.
        torque: of a backlash test.
        clocks: None where recording and moves have one clock.
        shipped: comes with the program, recorded on the emulated bench, and is not of this arm.
    """

    test: Test
    joint: str
    position: Finite | None = None
    position_name: str | None = None
    direction: Direction | None = None
    threshold_percent: Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
    lis: LeastStep | None = None
    lis_reason: str | None = None
    by_rule: Annotated[float, Field(gt=0.0, allow_inf_nan=False)] | None = None
    likely_mistake: LikelyMistake | None = None
    reversal: Reversal | None = None
    flags: list[str] = Field(default_factory=list)
    doubts: list[str] = Field(default_factory=list)
    pose: str | None = None
    duration_s: Uncertainty | None = None
    torque: Torque | None = None
    clocks: Clocks | None = None
    shipped: bool = False


class AngularTest(_Test):
    """Test of a joint that turns, in deg."""

    model_config = _DEG

    moves: list[AngularMove]
    staircase: AngularStaircase | None = None
    targets: list[AngularTarget] | None = None
    amplitudes: list[AngularAmplitude] | None = None

    @property
    def unit(self) -> Unit:
        """Of all its lengths or angles."""
        return "deg"


class LinearTest(_Test):
    """Test of a joint that slides, or of a Cartesian direction, in mm."""

    model_config = _MM

    moves: list[LinearMove]
    staircase: LinearStaircase | None = None
    targets: list[LinearTarget] | None = None
    amplitudes: list[LinearAmplitude] | None = None

    @property
    def unit(self) -> Unit:
        """Of all its lengths or angles."""
        return "mm"


def _unit_of(given: Any) -> Unit:
    """Return the unit that the keys of a test name."""
    if isinstance(given, _Test):
        return "mm" if isinstance(given, LinearTest) else "deg"
    if not isinstance(given, dict):
        return "deg"
    return "mm" if given.get("test") == "cartesian" or any(key.endswith("_mm") for key in given) else "deg"


AnyTest: TypeAlias = AngularTest | LinearTest


class Actuation(ResultPart):
    """What drives a joint.

    Attributes:
        joint: its name.
        gear_ratio: turns of the motor in one of the joint.
        encoder_bits: of the motor's single-turn encoder.
    """

    joint: str
    gear_ratio: Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
    encoder_bits: Annotated[int, Field(ge=1, le=64)]

    @property
    def ideal_lis_deg(self) -> float:
        """Smallest step that the encoder tells from none, at a joint without losses (the paper, Table 4)."""
        return 360.0 / 2.0**self.encoder_bits / self.gear_ratio


class MeasuredRun(ResultPart):
    """What a run says about how it was measured.

    Attributes:
        run: its name.
        started_utc: ISO 8601 UTC time.
        operator: who started it.
        devices: that answered, with firmware and serial number.
        optics: of the interferometer, as the cell describes them.
    """

    run: str
    started_utc: str
    operator: str
    devices: list[str]
    optics: list[str]


class ResolutionResult(ResultPart):
    """A whole result file.

    Attributes:
        format: name and version.
        arm: name of the arm's description.
        actuation: of the joints whose description says it.
        tests: in the order in which they were made.
        measured: the runs of the tests; empty for recordings of other programs.
        refused: tests of the runs that cannot be evaluated: which, and why.
        provenance: where they come from; None of a file that another program wrote.
    """

    format: Literal["catseye-resolution/1"] = RESOLUTION_FORMAT
    arm: str
    actuation: list[Actuation] = Field(default_factory=list)
    tests: list[
        Annotated[
            Annotated[AngularTest, Tag("deg")] | Annotated[LinearTest, Tag("mm")], Discriminator(_unit_of)
        ]
    ]
    measured: list[MeasuredRun] = Field(default_factory=list)
    refused: list[str] = Field(default_factory=list)
    provenance: Provenance | None = None


def resolution_text(result: ResolutionResult) -> str:
    """Return the text of a result file; what a test does not give is null."""
    return json.dumps(result.model_dump(mode="json", by_alias=True), ensure_ascii=False, indent=1) + "\n"


def write_resolution(result: ResolutionResult, path: Path) -> None:
    """Write a result file, whole or not at all."""
    write_atomically(path, resolution_text(result))


def read_resolution(path: Path) -> ResolutionResult:
    """Read a result file.

    Raises:
        UsageError: the file is missing or no result; names what is wrong.
    """
    return read_result_file(path, ResolutionResult, "catseye resolution")
