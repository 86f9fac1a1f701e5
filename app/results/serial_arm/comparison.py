"""Two calibrations of one arm against one another: parameters in combined uncertainties, and where they put the tool.

The base belongs to the instrument's frame, so that two instruments see it elsewhere: it is shown, and judged apart.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from catseye.app.errors import UsageError
from catseye.app.results.difference import Difference, difference_statement
from catseye.app.results.figures import Axis, Bars, Figure, Level, Panel, Points, Role
from catseye.app.results.model import (
    Block,
    Cell,
    Column,
    Origin,
    Quantity,
    Report,
    Sign,
    Statement,
    Table,
    section,
)
from catseye.app.results.numbers import EXPANDED, THREE_DIGITS, fixed, number
from catseye.app.results.origin import joined
from catseye.app.results.serial_arm.comparison_document import (
    ArmComparisonDocument,
    ComparedParameter,
    PlacesApart,
)
from catseye.app.results.serial_arm.figures import by_name
from catseye.app.results.serial_arm.identified_arm import identified_arm
from catseye.app.results.serial_arm.parameter_format import parameter_format
from catseye.app.results.serial_arm.result import SerialArmResult
from catseye.calibration.core.types import Floats
from catseye.calibration.kinematics.joint_ranges import ranges_of
from catseye.calibration.serial_arm.closed_form import rigid_motion
from catseye.calibration.serial_arm.geometry import Commands

_POSES = 1000
_SEED = 1
_SIGNED = fixed(1, signed=True)


@dataclass(frozen=True)
class ArmComparison:
    """Two results.

    Attributes:
        parameters: of both.
        only: names of parameters that one of them identified.
        target: name of the target whose places are compared.
        apart_mm: distances of its places at random poses, the frames brought together, shape (poses,).
        origin: of both results: what marks one of them marks the comparison.
    """

    parameters: tuple[Difference, ...]
    only: tuple[str, ...]
    target: str
    apart_mm: Floats
    origin: Origin

    @property
    def judged(self) -> list[tuple[str, float]]:
        """Names and normalised differences of the arm's own parameters; the base says where it stands."""
        return [
            (one.name, one.normalised)
            for one in self.parameters
            if one.normalised is not None and not one.name.startswith("base.")
        ]

    @property
    def largest(self) -> tuple[str, float] | None:
        """The parameter that differs most, in combined standard uncertainties."""
        return max(self.judged, key=lambda item: abs(item[1]), default=None)

    def document(self, first: Path, second: Path, limit_u: float | None = None) -> ArmComparisonDocument:
        """Return the JSON output.

        Args:
            first: file of the first result.
            second: file of the other.
            limit_u: largest difference that is no alarm, in combined standard uncertainties.
        """
        judged = [abs(size) for _, size in self.judged]
        apart = PlacesApart(
            poses=len(self.apart_mm), mean_mm=float(self.apart_mm.mean()), max_mm=float(self.apart_mm.max())
        )
        return ArmComparisonDocument(
            first=str(first),
            second=str(second),
            parameters=[ComparedParameter.model_validate(one) for one in self.parameters],
            only_in_one=list(self.only),
            within=sum(size <= EXPANDED for size in judged),
            judged=len(judged),
            target=self.target,
            places_apart=apart,
            limit_u=limit_u,
            beyond=[name for name, size in self.judged if limit_u is not None and abs(size) > limit_u],
        )


def compare_arms(first: SerialArmResult, second: SerialArmResult) -> ArmComparison:
    """Compare two results.

    Raises:
        UsageError: they are of arms with other joints.
    """
    known = [{one.name: one for one in each.parameters if one.identified} for each in (first, second)]
    both = [name for name in known[0] if name in known[1]]
    differences = tuple(
        Difference(
            name,
            known[0][name].unit,
            known[0][name].value,
            known[1][name].value,
            known[0][name].u,
            known[1][name].u,
        )
        for name in both
    )
    only = sorted(set(known[0]).symmetric_difference(known[1]))
    origin = joined([first.origin, second.origin])
    return ArmComparison(differences, tuple(only), *_apart(first, second), origin)


def _apart(first: SerialArmResult, second: SerialArmResult) -> tuple[str, Floats]:
    """Return a target that both have, and how far apart they put it at random poses."""
    arms = [identified_arm(one) for one in (first, second)]
    names = [[target.name for target in one.arm.targets] for one in arms]
    if arms[0].arm.joint_names != arms[1].arm.joint_names:
        raise UsageError("the results are of arms with other joints: compare two of one arm")
    shared = [name for name in names[0] if name in names[1]]
    if not shared:
        raise UsageError("the results have no target in common: calibrate both with one tool")
    poses = np.random.default_rng(_SEED).uniform(
        *ranges_of(arms[0].arm.chain), (_POSES, len(arms[0].arm.joint_names))
    )
    one, other = (
        arm.places_mm(Commands.of(arm.arm, poses), own.index(shared[0]))[0]
        for arm, own in zip(arms, names, strict=True)
    )
    onto = rigid_motion(other, one)
    return shared[0], np.linalg.norm(other @ onto[:3, :3].T + onto[:3, 3] - one, axis=1)


def comparison_report(found: ArmComparison, names: tuple[str, str]) -> Report:
    """Return what a comparison says."""
    blocks: list[Block] = [*_statements(found), _table(found)]
    figures = [_figure(found)] if found.judged else []
    return Report(
        f"{names[1]} minus {names[0]}",
        found.origin,
        (
            section("verdict", "Verdict", blocks, brief=True),
            section("figures", "Differences", figures),
        ),
    )


def _statements(found: ArmComparison) -> list[Statement]:
    mean, most = (number(float(value), fixed(3)) for value in (found.apart_mm.mean(), found.apart_mm.max()))
    apart = (
        f"With their frames brought together the two arms put {found.target} {mean} mm apart on average, {most} "
        f"mm at most, at {_POSES} random poses."
    )
    said = [Statement(Sign.NEUTRAL, apart)]
    if found.only:
        said.append(Statement(Sign.NEUTRAL, f"Only one of them identified {', '.join(found.only[:8])}."))
    largest = found.largest
    if largest is None:
        return [Statement(Sign.NEUTRAL, "No parameter of the arm has an uncertainty in both results."), *said]
    within = sum(abs(size) <= EXPANDED for _, size in found.judged)
    verdict = difference_statement(within, len(found.judged), "parameters of the arm", largest)
    return [verdict, *said]


def _table(found: ArmComparison) -> Table:
    columns = (
        Column("name", "parameter"),
        Column("unit", "unit"),
        Column("first", "first"),
        Column("second", "second"),
        Column("difference", "difference"),
        Column("u", "U (k=2)", standard=True),
        Column("normalised", "in u", format=_SIGNED),
    )
    return Table("differences", "Second minus first result", columns, tuple(map(_row, found.parameters)))


def _row(one: Difference) -> tuple[Cell, ...]:
    form = parameter_format(one.unit)
    return (
        one.name,
        one.unit,
        Quantity(one.first, form),
        Quantity(one.second, form),
        Quantity(one.difference, form),
        Quantity(one.u, THREE_DIGITS),
        one.normalised,
    )


def _figure(found: ArmComparison) -> Figure:
    names, sizes = zip(*found.judged, strict=True)
    levels = tuple(Level(end, Role.EXPECTED, dash="dashed") for end in (-EXPANDED, EXPANDED))
    heights, edges = np.histogram(found.apart_mm, 30)
    points = Points(np.arange(len(names), dtype=np.float64), np.array(sizes), Role.CHANGE)
    panels = (
        *(panel for (panel,) in by_name(names, points, "difference / combined u", levels)),
        Panel(
            "Places at random poses",
            Axis("distance / mm", low=0.0),
            Axis("poses"),
            (Bars(edges, heights.astype(np.float64), Role.SCATTER),),
        ),
    )
    caption = "Differences of the arm's own parameters, with ±2 dashed, and of the places of a target."
    return Figure(
        "differences",
        "Differences of two calibrations",
        caption,
        tuple((panel,) for panel in panels),
        aspect=0.35 * len(panels),
    )
