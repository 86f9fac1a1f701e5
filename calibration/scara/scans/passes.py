"""One pass over the distances of a scan: sums at given parameters."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from catseye.calibration.core.blockwise.normal_sums import NormalSums
from catseye.calibration.core.blockwise.residual_sums import ResidualSums
from catseye.calibration.core.blockwise.sparse_rows import Slot, SparseRows
from catseye.calibration.core.budget import stacked
from catseye.calibration.core.errors import CalibrationError
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.arm import LOCAL
from catseye.calibration.scara.between_nodes import MeasuredPlaces
from catseye.calibration.scara.budget import Budget, Correlation
from catseye.calibration.scara.budget_effects import stated_sigma_mm
from catseye.calibration.scara.distance_model import Beams, DistanceModel, distance_model
from catseye.calibration.scara.layout import Layout
from catseye.calibration.scara.pointing import beam_turn_rad
from catseye.calibration.scara.points import Points
from catseye.calibration.scara.scans.used_rows import UsedRows


@dataclass(frozen=True)
class Passes:
    """What each pass knows.

    Attributes:
        used: where the blocks come from.
        layout: order of the parameters.
        nominal_mm: nominal links, mm.
        rough_mm: rough places of the reflectors, mm, shape (reflectors, 2).
        budget: contributors; None for what the points state alone.
        places: where the joints stand between their nodes in all rows.
        estimate: where the contributors are taken, shape (p,); None for the nominal arm.
    """

    used: UsedRows
    layout: Layout
    nominal_mm: tuple[float, float]
    rough_mm: Floats
    budget: Budget | None
    places: MeasuredPlaces | None
    estimate: Floats | None = None

    def __post_init__(self) -> None:
        if common := self._correlated("pose"):
            raise CalibrationError(
                f"{common}: an error common to a pose cannot be separated from a reading's own in a scan, "
                "which repeats no pose; state it per reading"
            )
        if moved := self._correlated("segment"):
            raise CalibrationError(
                f"{moved}: a scan has too many segments for places of their own; leave the contributor out, or "
                "give a reflector that was moved another name"
            )

    def _correlated(self, how: Correlation) -> str:
        systematic = () if self.budget is None else self.budget.systematic
        return ", ".join(one.name for one in systematic if one.correlation == how)

    def start(self, few: Points) -> Floats:
        """Return starting values from rows of each segment, shape (p,)."""
        return self.model(few, weighted=False).start(*self.nominal_mm, self.rough_mm)

    def model(self, block: Points, *, weighted: bool = True) -> DistanceModel:
        """Prepare a block.

        Args:
            weighted: give them the uncertainty of the white contributors where they state none.
        """
        if any(term.source == "theta4" for term in self.layout.terms):
            block = replace(block, theta4_rad=beam_turn_rad(block, self.nominal_mm, self.rough_mm))
        model = distance_model(self.layout, block, self.budget, self.places)
        if not weighted or block.sigma_mm is not None or self.budget is None:
            return model
        sigma = stated_sigma_mm(self.budget, model.geometry(self.known))
        return replace(model, points=replace(block, sigma_mm=sigma))

    def sums(self, parameters: Floats, blocks: Iterable[Points], half_width_mm: float) -> NormalSums:
        """Return the sums over blocks at parameters of shape (p,)."""
        residuals = ResidualSums.empty(len(self.layout.dead_paths), half_width_mm)
        sums = NormalSums(self.layout.size, residuals)
        for block in blocks:
            model = self.model(block)
            weights = model.weights
            beams = model.beams(parameters)
            rows = sparse_rows(model, beams, parameters, weights)
            sums.add(rows, weights, block.dead_path)
            if self.budget is not None and self.budget.systematic:
                # Taken at the same parameters in each pass, for the sum of squares to be one and the same.
                shared = stacked(model.shared(self.known), len(block))
                sums.add_effects(rows, weights, shared * weights[:, None])
        return sums

    @property
    def known(self) -> Floats:
        """Where the contributors are taken, shape (p,)."""
        return self._nominal_parameters() if self.estimate is None else self.estimate

    def _nominal_parameters(self) -> Floats:
        parameters = np.zeros(self.layout.size)
        parameters[:2] = self.nominal_mm
        parameters[self.layout.reflectors] = np.ravel(self.rough_mm)
        return parameters


def sparse_rows(model: DistanceModel, beams: Beams, parameters: Floats, weights: Floats) -> SparseRows:
    """Return a block's residuals and weighted derivatives.

    Args:
        model: the block's points and commands.
        beams: at the parameters.
        parameters: where, shape (p,).
        weights: what each row is multiplied with, shape (n,); the residuals are not.
    """
    layout, design, points = model.layout, model.design, model.points
    unit, local = beams.unit * weights[:, None], beams.slopes * weights[:, None]
    whole = np.zeros(len(points), dtype=np.int64)
    slots = [Slot(0, 1, whole, local[:, 0]), Slot(1, 1, whole, local[:, 1])]
    for k in range(4):
        table = layout.map1 if k < 2 else layout.map2
        if table.stop > table.start:
            column, value = design.columns[:, k] - table.start, design.weights[:, k] * local[:, 2 + k // 2]
            slots.append(Slot(table.start, table.stop - table.start, column, value))
    for i, term in enumerate(layout.terms):
        answer = local[:, LOCAL[term.target]] if term.target in LOCAL else weights
        slots.append(Slot(layout.extension.start + i, 1, whole, design.extra[:, i] * answer))
    places = 2 * len(layout.reflector_names)
    for axis in range(2):
        slots.append(Slot(layout.reflectors.start, places, 2 * points.reflector + axis, -unit[:, axis]))
    slots.append(Slot(layout.dead_path.start, len(layout.dead_paths), points.dead_path, -weights))
    return SparseRows(model.residuals_of(beams.length_mm, parameters), tuple(slots), layout.size)
