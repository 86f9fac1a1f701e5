"""Fewer commands: which ones, within a number of them or a time at the bench."""

from dataclasses import dataclass

import numpy as np

from catseye.app.errors import UsageError
from catseye.app.results.scara.design.bench_time import BenchCost, bench_cost
from catseye.app.results.scara.design.layouts import Layout
from catseye.app.results.scara.design.problem import with_reflectors
from catseye.calibration.core.design.criteria import CriterionName, covariances
from catseye.calibration.core.design.information import Information
from catseye.calibration.core.design.row_choice import CommandPool, choose_commands
from catseye.calibration.core.types import Bools

_NEAR_ENOUGH = 4
"""Commands by which a choice for a bench time may stay below what would just fit."""


@dataclass(frozen=True)
class CommandChoice:
    """A part of the commands for a layout.

    Attributes:
        layout: the reflectors.
        kept: commands that are measured, shape (n,).
        cost: what the plan of them says.
        information: that they give about the arm.
        asked: how many were asked for.
    """

    layout: Layout
    kept: Bools
    cost: BenchCost
    information: Information
    asked: int | None = None

    def shown(self, name: CriterionName, *, systematic: bool) -> float:
        """Return the uncertainty that a criterion stands for; infinite where it is not determined."""
        criterion = self.layout.problem.with_criterion(name)
        value = float(criterion.value(covariances(self.information.counted(systematic=systematic))))
        return criterion.shown(value) if np.isfinite(value) else np.inf


def choose(layout: Layout, count: int) -> CommandChoice:
    """Choose so many commands; more where fewer would leave a parameter undetermined."""
    problem = layout.problem
    rows = [problem.study.rows(sight) for sight in layout.sights]
    kept = choose_commands(CommandPool.of(rows, systematic=problem.systematic), count, problem.criterion)
    parts = [row.of(kept).information() for row in rows]
    total = parts[0]
    for one in parts[1:]:
        total = total + one
    bench = with_reflectors(problem.bench, layout.sights)
    return CommandChoice(layout, kept, bench_cost(bench, problem.sequence, kept), total, count)


def choose_for_time(layout: Layout, limit_s: float) -> CommandChoice:
    """Choose as many commands as a bench time allows.

    Raises:
        UsageError: even the fewest commands that determine the arm take longer.
    """
    fewest, most = choose(layout, 1), len(layout.problem.sequence)
    if not fewest.cost.duration_s <= limit_s:
        raise UsageError(
            f"{limit_s / 60.0:g} min do not suffice: the {int(fewest.kept.sum())} commands that determine the arm at "
            f"all take {fewest.cost.duration_s / 60.0:.1f} min; allow more --minutes, or use fewer --reflectors"
        )
    best, low = fewest, int(fewest.kept.sum())
    while most - low > _NEAR_ENOUGH:
        middle = (low + most + 1) // 2
        trial = choose(layout, middle)
        if trial.cost.duration_s <= limit_s:
            best, low = trial, middle
        else:
            most = middle
    return best
