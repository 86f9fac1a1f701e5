"""How far apart may the nodes stand? Information criteria and cross-validation of other grids of nodes."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy import linalg

from catseye.calibration.core.errors import UnidentifiableError
from catseye.calibration.core.model import whitening_at
from catseye.calibration.core.projection import off_columns
from catseye.calibration.core.rank import require_identifiable
from catseye.calibration.core.significance import aicc, bic
from catseye.calibration.core.types import Bools, Floats
from catseye.calibration.core.whitening import Whitening
from catseye.calibration.scara.diagnostics.folds import predicted_residuals
from catseye.calibration.scara.diagnostics.problem import Problem
from catseye.calibration.scara.diagnostics.projection import DistanceProjection
from catseye.calibration.scara.diagnostics.thinning import thinned
from catseye.calibration.scara.distance_model import DistanceModel, distance_model
from catseye.calibration.scara.error_map import interpolate
from catseye.calibration.scara.identification import Identification, with_spectra
from catseye.calibration.scara.layout import Layout

_COARSER = (1, 2, 3)
"""Every node, every second, every third."""

_OFF_NODE_RAD = 1e-6


@dataclass(frozen=True)
class Grid:
    """One choice of nodes.

    Attributes:
        name: what it is.
        nodes1_rad: nodes of J1, rad.
        nodes2_rad: nodes of J2, rad.
        refused: why it could not be identified; None when it was.
        n_parameters: free parameters.
        rms_um: rms of the residuals, µm.
        aicc: information criterion.
        bic: information criterion.
        predicted_um: rms of sweeps of J2 that the others predict, µm, over the distances that every grid predicts.
    """

    name: str
    nodes1_rad: Floats
    nodes2_rad: Floats
    refused: str | None
    n_parameters: int
    rms_um: float
    aicc: float
    bic: float
    predicted_um: float


@dataclass(frozen=True)
class NodeSpacing:
    """All grids that were tried.

    Attributes:
        grids: the present one first.
        between1: commands of J1 stand between its nodes too, so that finer nodes can be judged.
        between2: the same of J2.
    """

    grids: tuple[Grid, ...]
    between1: bool
    between2: bool

    @property
    def by_aicc(self) -> Grid:
        """The grid that Akaike's criterion prefers."""
        return min(self.grids, key=lambda one: one.aicc)

    @property
    def by_bic(self) -> Grid:
        """The grid that Schwarz's criterion prefers."""
        return min(self.grids, key=lambda one: one.bic)

    @property
    def by_prediction(self) -> Grid | None:
        """The grid that predicts left-out sweeps best; None where none can."""
        able = [one for one in self.grids if np.isfinite(one.predicted_um)]
        return min(able, key=lambda one: one.predicted_um, default=None)


def node_spacing(
    problem: Problem,
    progress: Callable[[str], None] = lambda _: None,
    identified: Identification | None = None,
) -> NodeSpacing:
    """Try coarser grids, and finer ones where commands stand between the nodes.

    All grids are judged by one covariance, whose sizes are estimated beside the finest one that is determined.
    Of a long table, evenly spread distances decide.

    Args:
        problem: distances with the present nodes.
        progress: called with the name of each grid when its turn comes.
        identified: what the problem's solution is, where it is known.

    Raises:
        CalibrationError: the present grid cannot be identified.
    """
    found = thinned(problem.solve() if identified is None else identified)
    commands = found.points.commands
    between = (
        _between(problem.nodes1_rad, commands.theta1_rad),
        _between(problem.nodes2_rad, commands.theta2_rad),
    )
    choices1 = _choices(problem.nodes1_rad, between[0])
    choices2 = _choices(problem.nodes2_rad, between[1])
    finest = _Finest.of(problem, found, *(_most([one for _, one in some]) for some in (choices1, choices2)))
    tried = []
    for word1, nodes1 in choices1:
        for word2, nodes2 in choices2:
            name = f"J1 {word1} ({nodes1.size}), J2 {word2} ({nodes2.size})"
            progress(name)
            tried.append(_grid(finest, name, nodes1, nodes2))
    return NodeSpacing(_with_common_rows(tried), *between)


@dataclass(frozen=True)
class _Finest:
    """The finest grid, which contains all others.

    Attributes:
        model: of the distances with it.
        values: its parameters where it does what the present grid does, shape (p,).
        jacobian: its derivatives there, shape (n, p).
        whitening: that all grids share.
    """

    model: DistanceModel
    values: Floats
    jacobian: Floats
    whitening: Whitening

    @classmethod
    def of(cls, problem: Problem, found: Identification, nodes1: Floats, nodes2: Floats) -> "_Finest":
        present, asked = found.model, problem.asked
        layout = replace(found.layout, nodes1_rad=nodes1, nodes2_rad=nodes2)
        model = distance_model(layout, found.points, asked)
        values = _embedding(found.layout, layout) @ found.parameters
        jacobian = model.jacobian(values)
        if asked is not None:
            determined = _why_not(layout, jacobian * model.weights[:, None]) is None
            beside = (model, values) if determined else (replace(present, budget=asked), found.parameters)
            present = replace(present, budget=with_spectra(asked, *beside, for_test=True))
        return cls(model, values, jacobian, whitening_at(present, found.parameters))


def _why_not(layout: Layout, weighted: Floats) -> str | None:
    """Return what the distances lack to determine a grid; None where they do."""
    try:
        require_identifiable(layout.parameters(), weighted)
    except UnidentifiableError as error:
        return str(error)
    return None


def _between(nodes_rad: Floats, theta_rad: Floats) -> bool:
    """Return whether a good part of the commands stands between the nodes."""
    distance = np.min(np.abs(theta_rad[:, None] - nodes_rad[None, :]), axis=1)
    return bool(np.mean(distance > _OFF_NODE_RAD) > 0.2)


def _choices(nodes_rad: Floats, between: bool) -> list[tuple[str, Floats]]:
    words = {1: "every node", 2: "every 2nd", 3: "every 3rd"}
    choices = [(words[step], _thinned(nodes_rad, step)) for step in _COARSER]
    distinct = [one for i, one in enumerate(choices) if i == 0 or one[1].size < choices[i - 1][1].size]
    if between and nodes_rad.size > 1:
        middle = (nodes_rad[1:] + nodes_rad[:-1]) / 2.0
        distinct.append(("halved", np.sort(np.concatenate([nodes_rad, middle]))))
    return distinct


def _most(nodes: list[Floats]) -> Floats:
    return max(nodes, key=lambda one: one.size)


def _thinned(nodes_rad: Floats, step: int) -> Floats:
    """Return every so many-th node; the last one stays, since a map is never extrapolated."""
    kept = nodes_rad[::step]
    return kept if kept[-1] == nodes_rad[-1] else np.append(kept, nodes_rad[-1])


def _grid(finest: _Finest, name: str, nodes1: Floats, nodes2: Floats) -> tuple[Grid, Floats | None]:
    layout = replace(finest.model.layout, nodes1_rad=nodes1, nodes2_rad=nodes2)
    embedding, own = _embedding(layout, finest.model.layout), _embedding(finest.model.layout, layout)
    columns = finest.jacobian @ embedding
    refused = _why_not(layout, columns * finest.model.weights[:, None])
    if refused is not None:
        return Grid(name, nodes1, nodes2, refused, 0, np.nan, np.inf, np.inf, np.nan), None
    # From where the coarser map does the same at its own nodes, one step of least squares.
    residuals = finest.model.residuals(embedding @ (own @ finest.values))
    fit = off_columns(
        finest.whitening, finest.whitening.rows(columns @ layout.gauge_basis()), residuals
    ).settled
    projection = DistanceProjection(
        fit.whitening, fit.orthonormal, fit.residuals, finest.model.geometry(finest.values)
    )
    free = projection.orthonormal.shape[1]
    size = projection.square, residuals.size, free
    grid = Grid(name, nodes1, nodes2, None, free, projection.rms_um, aicc(*size), bic(*size), np.nan)
    return grid, predicted_residuals(projection, "sweep")


def _embedding(given: Layout, wanted: Layout) -> Floats:
    """Return what turns parameters of one grid into those of another, shape (p wanted, p given).

    A map is read at the other's nodes: exact where these are finer, those of its own where they are coarser.
    """
    matrix = np.zeros((wanted.size, given.size))
    matrix[:2, :2] = np.eye(2)
    for one, other, nodes, places in (
        (given.map1, wanted.map1, given.nodes1_rad, wanted.nodes1_rad),
        (given.map2, wanted.map2, given.nodes2_rad, wanted.nodes2_rad),
    ):
        read = interpolate(nodes, places)
        table, row = np.zeros((places.size, nodes.size)), np.arange(places.size)
        table[row, read.lower] = 1.0 - read.alpha
        table[row, np.minimum(read.lower + 1, nodes.size - 1)] += read.alpha
        matrix[other, one] = linalg.block_diag(table, table)
    rest = given.size - given.map2.stop
    matrix[wanted.map2.stop :, given.map2.stop :] = np.eye(rest)
    return matrix


def _with_common_rows(tried: list[tuple[Grid, Floats | None]]) -> tuple[Grid, ...]:
    """Work out the predictions over the distances that every grid predicts."""
    known = [predicted for _, predicted in tried if predicted is not None]
    common: Bools = np.all(np.isfinite(known), axis=0)
    return tuple(
        grid
        if predicted is None or not common.any()
        else replace(grid, predicted_um=1e3 * float(np.sqrt(np.mean(predicted[common] ** 2))))
        for grid, predicted in tried
    )
