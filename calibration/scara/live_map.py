"""What the distances measured so far say about the maps, kept up to date while measuring.

Information is summed row by row. The dead path of a segment is eliminated by taking its rows from their mean, which
is updated with every row. Radial error motions and what changes with time are unknowns with a known spread beside
the parameters: predictions and standard uncertainties are those of the identification's generalised least squares.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy import linalg

from catseye.calibration.core.arguments import require_count, require_finite, require_positive
from catseye.calibration.core.centred_sums import CentredSums
from catseye.calibration.core.errors import ArgumentError
from catseye.calibration.core.gauge import Gauge
from catseye.calibration.core.rank import known_variances
from catseye.calibration.core.types import Bools, Floats, Ints
from catseye.calibration.core.whitening import through_sources
from catseye.calibration.scara.arm import arm_design
from catseye.calibration.scara.budget import Budget, Contributor
from catseye.calibration.scara.budget_effects import seen_along, systematic_effects
from catseye.calibration.scara.layout import Layout
from catseye.calibration.scara.planar import require_links
from catseye.calibration.scara.points import Commands, Points
from catseye.calibration.scara.radial import RadialBudget, radial_effects

_PRIOR_LINK_MM = 10.0
_PRIOR_MAP_RAD = 0.05
_PRIOR_PLACE_MM = 50.0
"""Standard uncertainties of the start: so large that they count for nothing once distances are measured."""

_PRIOR_SHARE = 1e-3
"""A point is predictable when less than this share of its variance comes from the prior of the start."""

_CURVATURE_SHARE = 0.1
"""The derivatives are taken anew when what they neglect may exceed this share of the white uncertainty."""

_NEAR_MM = 0.05
"""An estimate that is nearer to the origin of the derivatives changes no standard uncertainty by a thousandth."""

_TOUCH = 1e-5
"""A parameter is touched when distances move by more than this share of what they can move by it."""

_MOST_NAMED = 6

_GROWTH = 512
"""Rows that room is made for at first; it is doubled whenever it is full."""


@dataclass(frozen=True)
class Innovation:
    """What a distance says beyond all distances before it.

    Attributes:
        value_mm: measured minus predicted.
        u_mm: standard uncertainty of that difference: of the prediction and of the distance.
    """

    value_mm: float
    u_mm: float

    @property
    def normalised(self) -> float:
        """The value in units of its standard uncertainty."""
        return self.value_mm / self.u_mm


@dataclass(frozen=True)
class Changes:
    """What changes while distances are measured one after the other.

    Attributes:
        contributors: those that change with time, as large as they state.
        rows: distances expected in all: the share that has passed follows from them.
    """

    contributors: tuple[Contributor, ...]
    rows: int

    def __post_init__(self) -> None:
        require_count(self.rows, "rows of a measurement")
        if other := [one.name for one in self.contributors if one.correlation != "time"]:
            raise ArgumentError(f"{', '.join(other)}: no contributor that changes with time")

    @property
    def sources(self) -> int:
        """How many sources of unit variance there are."""
        return sum(one.orders for one in self.contributors)

    def elapsed(self, number: Ints | int) -> Floats:
        """Return the share of the measurement that had passed at a distance, less a half."""
        return np.asarray(number) / max(self.rows - 1, 1) - 0.5


@dataclass(frozen=True)
class MapKnowledge:
    """How well both maps are known, in the gauge "mean of the Δθ1 table over both directions = 0".

    Attributes:
        u1_rad: largest standard uncertainty of Δθ1, rad; None while a node is not determined.
        u2_rad: the same of Δθ2.
        reason: which nodes are not determined yet; empty when all are.
    """

    u1_rad: float | None
    u2_rad: float | None
    reason: str


@dataclass(frozen=True)
class MapsSoFar:
    """Both maps as far as the distances determine them, NaN elsewhere; the mean of Δθ1 where it was measured is 0.

    Attributes:
        map1_rad: Δθ1 at the nodes, approached upwards and downwards, shape (2, m1).
        u1_rad: its standard uncertainties.
        map2_rad: Δθ2, shape (2, m2).
        u2_rad: its standard uncertainties.
    """

    map1_rad: Floats
    u1_rad: Floats
    map2_rad: Floats
    u2_rad: Floats


class LiveMap:
    """Links, maps and reflectors of an arm while it is being measured.

    A point takes less than a twentieth of an `identify` all over again, and what is known less than a quarter, at
    1056 points of the paper's layout with 60 radial contributors (tests/benchmarks/test_live_map.py). The
    default budget's 34 sources of what changes with time make a point take half as long again.
    """

    def __init__(
        self,
        nodes1_rad: Floats,
        nodes2_rad: Floats,
        link1_mm: float,
        link2_mm: float,
        reflectors_mm: Mapping[str, tuple[float, float]],
        white_mm: float,
        radial: RadialBudget | None = None,
        changes: Changes | None = None,
    ) -> None:
        """Begin without a distance.

        Args:
            nodes1_rad: nodes of the J1 map, rad, strictly increasing.
            nodes2_rad: nodes of the J2 map, rad, strictly increasing.
            link1_mm: nominal length of link 1, mm.
            link2_mm: nominal length of link 2, mm.
            reflectors_mm: rough places by name, mm.
            white_mm: standard uncertainty of a distance that differs from distance to distance, mm.
            radial: radial error motions, which repeat with the angles; None for none.
            changes: what changes with time; None for nothing.

        Raises:
            ArgumentError: white_mm or a link is not positive, or nodes do not increase.
        """
        require_positive(white_mm, "white_mm")
        require_links(link1_mm, link2_mm)
        require_finite(list(reflectors_mm.values()), "reflectors_mm")
        self._layout = Layout("error-map", nodes1_rad, nodes2_rad, tuple(reflectors_mm), ())
        self._white_mm = white_mm
        self._radial = radial
        self._changes = changes
        self._reach_mm = link1_mm + link2_mm
        self._start = np.zeros(self._layout.size)
        self._start[:2] = link1_mm, link2_mm
        self._start[self._layout.reflectors] = np.ravel(list(reflectors_mm.values()))
        self._origin = self._start.copy()
        self._table = np.empty((_GROWTH, 8))
        self._keys: list[tuple[int, int]] = []
        self._nearest_mm = math.inf
        self._sums = CentredSums.empty(self._columns)
        self._prior = self._prior_information()
        self._solve()

    def __len__(self) -> int:
        """Return the number of distances."""
        return len(self._keys)

    def add(
        self,
        theta1_rad: float,
        theta2_rad: float,
        direction1: int,
        direction2: int,
        reflector: str,
        segment: int,
        displacement_mm: float,
        mount_rad: float = 0.0,
        number: int | None = None,
    ) -> Innovation | None:
        """Take a distance in.

        Args:
            direction1: state of approach of J1, 1 or -1.
            direction2: state of approach of J2, 1 or -1.
            segment: number of the segment; it counts within its reflector.
            displacement_mm: distance relative to the zero of the segment, mm.
            mount_rad: by how much the interferometer is turned on J4's flange.
            number: among all distances of the measurement, from 0; None where all of them are taken in.

        Returns:
            Measured minus predicted from all distances before; None when they do not determine it.

        Raises:
            MapRangeError: the command lies outside the nodes.
            ArgumentError: the reflector is unknown, a direction is not 1 or -1, or the distance is not a number.
        """
        if reflector not in self._layout.reflector_names:
            known = ", ".join(self._layout.reflector_names)
            raise ArgumentError(
                f"reflector {reflector} is not among those that the map was begun with: {known}"
            )
        require_finite(displacement_mm, f"displacement_mm to reflector {reflector}")
        index = self._layout.reflector_names.index(reflector)
        key = (index, segment)
        elapsed = float(self._elapsed(len(self) if number is None else number))
        row = np.array(
            [theta1_rad, theta2_rad, direction1, direction2, index, displacement_mm, mount_rad, elapsed]
        )
        stacked = self._stacked(row[None, :])[0]
        innovation = self._innovation(stacked, key)
        self._keep(row, key)
        self._sums.add(stacked, key)
        self._solve()
        if self._bent():
            self._relinearise()
        return innovation

    def foresee(self, commands: Commands, reflector: str) -> None:
        """Take in, at once, how well further distances to a reflector will determine the maps, whatever they are.

        Args:
            commands: of the distances, which share one dead path.
        """
        index = self._layout.reflector_names.index(reflector)
        design = arm_design(self._layout, commands)
        place = self._start[self._layout.reflectors].reshape(-1, 2)[index]
        # Just as long as the arm is taken to be: nothing is to be corrected.
        length = np.hypot(*(design.positions(self._origin) - place).T)
        number = np.arange(len(self), len(self) + len(commands))
        elapsed = self._elapsed(number)
        columns = (commands.theta1_rad, commands.theta2_rad, commands.direction1, commands.direction2)
        same = np.full(len(commands), index), length, np.zeros(len(commands)), elapsed
        for row in np.column_stack([*columns, *same]):
            self._keep(row, (index, 0))
        self._sums = CentredSums.of(self._stacked(self._table[: len(self)]), self._keys)
        self._solve()

    def _elapsed(self, number: Ints | int) -> Floats:
        """Return the share of the measurement that had passed, less a half; 0 where nothing changes with it."""
        return np.zeros(np.shape(number)) if self._changes is None else self._changes.elapsed(number)

    def maps(self) -> MapsSoFar:
        """Return both maps as far as the distances so far determine them."""
        if self._keys and self._moved_mm() > _NEAR_MM:
            self._relinearise()
        layout, touched = self._layout, self._touched()
        values, u = np.full(layout.size, np.nan), np.full(layout.size, np.nan)
        seen = np.flatnonzero(touched[layout.map1]) + layout.map1.start
        if seen.size:
            # Where nothing was measured nothing can be held at zero.
            first = int(touched[: layout.map1.start].sum())
            basis = Gauge.mean_of(slice(first, first + seen.size), int(touched.sum())).basis
            variance, loose = known_variances(self._information()[np.ix_(touched, touched)], basis)
            u[touched] = np.where(loose, np.nan, np.sqrt(variance))
            values = self._origin + self._step
            values[layout.map1] -= values[seen].mean()
            values[np.isnan(u)] = np.nan
        parts = [array[part].reshape(2, -1) for part in (layout.map1, layout.map2) for array in (values, u)]
        return MapsSoFar(*parts)

    def known(self) -> MapKnowledge:
        """Return how well the distances so far determine the maps; never a number that they do not determine."""
        if not self._keys:
            return MapKnowledge(None, None, "no distance has been measured yet")
        if self._moved_mm() > _NEAR_MM:
            self._relinearise()
        layout, basis = self._layout, self._layout.gauge_basis()
        variance, loose = known_variances(self._information(), basis)
        reasons = []
        u: list[float | None] = []
        for name, part in (("θ1", layout.map1), ("θ2", layout.map2)):
            if loose[part].any():
                reasons.append(self._reason(name, part, loose))
                u.append(None)
            else:
                u.append(math.sqrt(float(variance[part].max())))
        return MapKnowledge(u[0], u[1], "; ".join(reasons))

    @property
    def _columns(self) -> int:
        radial = 0 if self._radial is None else 12 * self._radial.orders
        changing = 0 if self._changes is None else self._changes.sources
        return self._layout.size + radial + changing

    def _information(self) -> Floats:
        """Return what the distances say of the parameters, shape (p, p)."""
        size, sums = self._layout.size, self._sums.matrix[:-1, :-1] * self._white_mm**-2
        touched = self._touched()[:, None]
        return through_sources(
            sums[:size, :size] * (touched * touched.T), sums[:size, size:] * touched, sums[size:, size:]
        )

    def _touched(self) -> Bools:
        """Return which parameters move any distance, shape (p,).

        Rows of a segment that are all alike leave rounding where nothing is left of them; it is no information.
        """
        lever = np.ones(self._layout.size)
        lever[2 : self._layout.arm_size] = self._reach_mm
        return np.asarray(np.diag(self._sums.matrix)[: self._layout.size] > (_TOUCH * lever) ** 2)

    def _prior_information(self) -> Floats:
        """Return the information of the start and of the shared errors, diagonal, shape (columns,)."""
        spread = np.ones(self._columns)
        spread[:2] = _PRIOR_LINK_MM
        spread[2 : self._layout.arm_size] = _PRIOR_MAP_RAD
        spread[self._layout.reflectors] = _PRIOR_PLACE_MM
        return spread**-2

    def _solve(self) -> None:
        """Solve for parameters and shared errors relative to the origin of the derivatives."""
        size, scale = self._layout.size, self._white_mm**-2
        matrix = self._sums.matrix[:-1, :-1] * scale
        matrix.flat[:: self._columns + 1] += self._prior
        # Fixes the gauge with as much information as a distance has; no distance resists.
        turns = self._layout.map1
        matrix[turns, turns] += scale * self._reach_mm**2 / (turns.stop - turns.start)
        right = -self._sums.matrix[:-1, -1] * scale
        right[:size] += self._prior[:size] * (self._start - self._origin)
        self._factor = linalg.cho_factor(matrix, lower=True, overwrite_a=True, check_finite=False)
        self._solution = linalg.cho_solve(self._factor, right, check_finite=False)

    @property
    def _step(self) -> Floats:
        return np.asarray(self._solution[: self._layout.size], dtype=np.float64)

    def _innovation(self, stacked: Floats, key: tuple[int, int]) -> Innovation | None:
        size, white = self._layout.size, self._white_mm**2
        count = self._sums.counts.get(key, 0)
        if count == 0:
            return None
        from_mean = stacked - self._sums.means[key]
        spread = linalg.cho_solve(self._factor, from_mean[:-1], check_finite=False)
        variance = float(from_mean[:-1] @ spread) + white * (1.0 + 1.0 / count)
        if float(self._prior[:size] @ spread[:size] ** 2) > _PRIOR_SHARE * variance:
            return None
        value = -float(from_mean[-1] + from_mean[:-1] @ self._solution)
        return Innovation(value, math.sqrt(variance))

    def _bent(self) -> bool:
        """Return whether the estimate has left the neighbourhood in which the derivatives hold."""
        allowed = 2.0 * self._nearest_mm * _CURVATURE_SHARE * self._white_mm
        return self._moved_mm() ** 2 > allowed

    def _moved_mm(self) -> float:
        """Return how far the estimate lies from the origin of the derivatives; angles count at full reach."""
        step = np.abs(self._step)
        step[2 : self._layout.arm_size] *= self._reach_mm
        return float(step.max())

    def _relinearise(self) -> None:
        self._origin = self._origin + self._step
        self._sums = CentredSums.of(self._stacked(self._table[: len(self)]), self._keys)
        self._solve()

    def _keep(self, row: Floats, key: tuple[int, int]) -> None:
        if len(self) == len(self._table):
            self._table = np.vstack([self._table, np.empty_like(self._table)])
        self._table[len(self)] = row
        self._keys.append(key)

    def _stacked(self, table: Floats) -> Floats:
        """Return derivatives, effects of shared errors and residual of rows, shape (n, columns + 1)."""
        points = _points(table, self._layout)
        layout, origin = self._layout, self._origin
        design = arm_design(layout, points.commands)
        position = design.positions(origin)
        beam = position - origin[layout.reflectors].reshape(-1, 2)[points.reflector]
        length = np.hypot(beam[:, 0], beam[:, 1])
        self._nearest_mm = min(self._nearest_mm, float(length.min()))
        unit = beam / length[:, None]
        stacked = np.zeros((len(table), self._columns + 1))
        local = np.einsum("ni,nij->nj", unit, design.local_jacobian(origin))
        stacked[:, : layout.arm_size] = design.spread(local)
        place = layout.reflectors.start + 2 * points.reflector
        number = np.arange(len(table))
        stacked[number, place] = -unit[:, 0]
        stacked[number, place + 1] = -unit[:, 1]
        changing = self._columns - (0 if self._changes is None else self._changes.sources)
        if self._radial is not None:
            stacked[:, layout.size : changing] = radial_effects(points, unit, self._radial)
        if self._changes is not None:
            seen = seen_along(points, position, (unit, length), local[:, 2:], layout)
            stacked[:, changing:-1] = systematic_effects(
                Budget(self._changes.contributors), replace(seen, elapsed=table[:, 7])
            )
        stacked[:, -1] = length - points.displacement_mm
        return stacked

    def _reason(self, name: str, part: slice, loose: Bools) -> str:
        names = self._layout.names()
        untouched = ~self._touched()
        chosen = untouched if untouched[part].any() else loose
        nodes = [names[i] for i in range(part.start, part.stop) if chosen[i]]
        more = f" and {len(nodes) - _MOST_NAMED} more" if len(nodes) > _MOST_NAMED else ""
        what = "not measured yet" if chosen is untouched else "not separable yet"
        return f"Δ{name} {what}: {', '.join(nodes[:_MOST_NAMED])}{more}"


def _points(table: Floats, layout: Layout) -> Points:
    """Return rows of θ1, θ2, directions, reflector, displacement, mounting and time as points without dead paths."""
    whole = table[:, 2:5].astype(np.int64)
    commands = Commands(table[:, 0], table[:, 1], whole[:, 0], whole[:, 1])
    # Each row on its own: what a segment has in common is taken off later.
    alone = np.arange(len(table))
    return Points(
        commands,
        whole[:, 2],
        alone,
        table[:, 5],
        None,
        layout.reflector_names,
        (("", 0),) * len(table),
        mount_rad=table[:, 6],
    )
