"""A problem of identification that can be put again with other points, nodes or terms."""

from dataclasses import dataclass, replace

from catseye.calibration.core.types import Bools, Floats, Ints
from catseye.calibration.scara.budget import Budget
from catseye.calibration.scara.extension import Term
from catseye.calibration.scara.identification import Identification, counted_budget, identify
from catseye.calibration.scara.layout import ModelName
from catseye.calibration.scara.points import Points


@dataclass(frozen=True)
class Problem:
    """What `catseye.calibration.scara.identification.identify` is asked.

    Attributes:
        points: measured distances.
        model: which model.
        nodes1_rad: nodes of the J1 map, rad, shape (m1,).
        nodes2_rad: nodes of the J2 map, rad, shape (m2,).
        link1_mm: nominal length of link 1, mm.
        link2_mm: nominal length of link 2, mm.
        reflectors_mm: rough places of points.reflector_names, mm, shape (reflectors, 2).
        budget: contributors of the uncertainty; None for what the points state.
        terms: functions beyond the model.
    """

    points: Points
    model: ModelName
    nodes1_rad: Floats
    nodes2_rad: Floats
    link1_mm: float
    link2_mm: float
    reflectors_mm: Floats
    budget: Budget | None = None
    terms: tuple[Term, ...] = ()

    @property
    def asked(self) -> Budget | None:
        """What counts of the budget; the distances have not been asked how large its harmonics are."""
        return counted_budget(self.points, self.budget)

    def rough_places(self, points: Points) -> Floats:
        """Return the rough places of the reflectors of some of the points, mm, shape (reflectors, 2)."""
        return self.reflectors_mm[
            [self.points.reflector_names.index(name) for name in points.reflector_names]
        ]

    def solve(self) -> Identification:
        """Identify.

        Raises:
            CalibrationError: as `identify` does.
        """
        return identify(
            self.points,
            self.model,
            self.nodes1_rad,
            self.nodes2_rad,
            self.link1_mm,
            self.link2_mm,
            self.reflectors_mm,
            self.budget,
            self.terms,
        )

    def of_rows(self, rows: Bools | Ints) -> "Problem":
        """Return the problem of some of the distances; reflectors that lose all of theirs are left out."""
        points = self.points.select(rows)
        return replace(self, points=points, reflectors_mm=self.rough_places(points))
