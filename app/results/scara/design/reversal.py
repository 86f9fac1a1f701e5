"""What it is worth to measure a second time with the interferometer turned by half a turn on J4's flange."""

from dataclasses import dataclass, replace

from catseye.app.results.scara.design.layouts import Layout, layout_of
from catseye.calibration.scara.design.reversal import measured_twice, seen_twice


@dataclass(frozen=True)
class Reversal:
    """A layout measured twice.

    Attributes:
        once: measured once.
        again: measured a second time in the same mounting.
        turned: measured a second time with the interferometer turned.
    """

    once: Layout
    again: Layout
    turned: Layout

    @property
    def ways(self) -> tuple[tuple[str, Layout], ...]:
        """Each way to measure, by what a table calls it."""
        return ("once", self.once), ("twice", self.again), ("twice, turned between", self.turned)


def reversals(layouts: tuple[Layout, ...]) -> tuple[Reversal, ...]:
    """Return what turning is worth to layouts; nothing where no error of the budget follows J4's angle."""
    return tuple(_reversal(one) for one in layouts if one.problem.study.budget.follows_j4)


def _reversal(layout: Layout) -> Reversal:
    again, turned = (_twice(layout, turned=turned) for turned in (False, True))
    return Reversal(layout, again, turned)


def _twice(layout: Layout, *, turned: bool) -> Layout:
    problem = replace(layout.problem, study=measured_twice(layout.problem.study, turned=turned))
    return layout_of(problem, layout.name, [seen_twice(sight) for sight in layout.sights])
