"""Models on a path that the interferometer measured: predicted against measured distances."""

from dataclasses import dataclass, replace

import numpy as np

from catseye.app.errors import UsageError
from catseye.calibration.core.errors import InsufficientPointsError
from catseye.calibration.core.quadratic_form import SumOfSquares
from catseye.calibration.core.types import Bools, Floats, Ints
from catseye.calibration.scara.arm import arm_design
from catseye.calibration.scara.distance_model import DistanceModel
from catseye.calibration.scara.identification import Identification
from catseye.calibration.scara.pointing import beam_turn_rad
from catseye.calibration.scara.points import Points
from catseye.calibration.scara.prediction import inside_range
from catseye.calibration.scara.prediction_errors import PredictionErrors, prediction_errors
from catseye.procedures.scara.path_lines import stretches

_FEWEST = 3
"""Distances of a segment: its dead path is fitted, so that one alone agrees with any model, and two with most."""


@dataclass(frozen=True)
class DistancePath:
    """A path measured by distances to reflectors.

    Attributes:
        points: commands with directions of approach, and distances relative to the zero of each segment, n rows.
        command_mm: command positions, shape (n, 2).
        travel: 1 on the way there, -1 on the way back, shape (n,).
        established: rows whose joints have moved at least the take-up angle since their last reversal, shape (n,).
        stretch: place of the line of a pass that each row belongs to, shape (n,); None for one line.
    """

    points: Points
    command_mm: Floats
    travel: Ints
    established: Bools
    stretch: Ints | None = None

    @property
    def lines(self) -> list[slice]:
        """The rows of each line of each pass, in order."""
        return stretches(
            np.zeros(len(self.command_mm), dtype=np.int64) if self.stretch is None else self.stretch
        )


@dataclass(frozen=True)
class ModelOnDistances:
    """One model on the path.

    Attributes:
        model: "conventional" or "error-map".
        deviation_mm: measured minus predicted distance, one dead path fitted for each segment, shape (n,); NaN where
            it is not compared.
        u_mm: standard uncertainty of that deviation, shape (n,); NaN likewise.
        dead_paths_mm: fitted dead paths by reflector and segment.
        probability: of deviations this large if the stated uncertainties are all there is; None where nobody states
            by how much single distances scatter.
    """

    model: str
    deviation_mm: Floats
    u_mm: Floats
    dead_paths_mm: dict[tuple[str, int], float]
    probability: float | None

    @property
    def rms_um(self) -> float:
        """Rms of the deviations, µm."""
        return 1e3 * float(np.sqrt(np.nanmean(self.deviation_mm**2)))

    @property
    def max_um(self) -> float:
        """Largest deviation, µm."""
        return 1e3 * float(np.nanmax(np.abs(self.deviation_mm)))

    @property
    def median_u_um(self) -> float:
        """Median of the standard uncertainties, µm."""
        return 1e3 * float(np.nanmedian(self.u_mm))


@dataclass(frozen=True)
class DistanceValidation:
    """All models on the path.

    Attributes:
        path: what was measured.
        compared: rows that every model is compared over, shape (n,).
        models: one entry a model, in the order given.
        rejected: sentences about segments that are too short.
    """

    path: DistancePath
    compared: Bools
    models: tuple[ModelOnDistances, ...]
    rejected: tuple[str, ...]

    @property
    def ratio(self) -> float | None:
        """Rms left by the last model over that left by the first, None for a single model."""
        if len(self.models) < 2:
            return None
        return self.models[-1].rms_um / self.models[0].rms_um


def validate_on_distances(path: DistancePath, identified: list[Identification]) -> DistanceValidation:
    """Compare models with measured distances, all over the same rows.

    Distances do not see a rotation of arm and reflectors about J1 together, so nothing is aligned; each segment has a
    dead path of its own, which is fitted for each model.

    Args:
        identified: the models, the reference (conventional) first.

    Raises:
        UsageError: a model does not know a reflector of the path.
        InsufficientPointsError: no segment has three rows to compare.
    """
    for identification in identified:
        _require_reflectors(identification, path)
    usable: Bools = np.logical_and.reduce(
        [
            path.established,
            *(inside_range(identification.arm, path.points.commands) for identification in identified),
        ]
    )
    compared, rejected = _without_short_segments(path.points, usable)
    if not compared.any():
        raise InsufficientPointsError(
            f"no segment of the path has {_FEWEST} distances inside the identified range and with an established "
            "direction of approach: nothing can be compared"
        )
    models = tuple(_on_distances(path, identification, compared) for identification in identified)
    return DistanceValidation(path, compared, models, rejected)


def _require_reflectors(identified: Identification, path: DistancePath) -> None:
    known = identified.layout.reflector_names
    for name in path.points.reflector_names:
        if name not in known:
            raise UsageError(
                f"the {identified.layout.model} model was identified without reflector {name}, to which the path was "
                f"measured; it knows {', '.join(known)}: identify from points of {name} too, or measure the path to "
                "one of those (param reflector)"
            )


def _without_short_segments(points: Points, usable: Bools) -> tuple[Bools, tuple[str, ...]]:
    counts = np.bincount(points.dead_path[usable], minlength=len(points.dead_paths))
    short = counts < _FEWEST
    sentences = tuple(
        f"segment {segment} of reflector {name} left out: {counts[i]} distance(s) to compare, fewer than {_FEWEST}"
        for i, (name, segment) in enumerate(points.dead_paths)
        if short[i]
    )
    return usable & ~short[points.dead_path], sentences


def _on_distances(path: DistancePath, identified: Identification, compared: Bools) -> ModelOnDistances:
    points = path.points.select(compared)
    model, parameters = _transferred(identified, points)
    length_less_count = model.residuals(parameters)
    # Without weights the best dead path of a segment is the mean.
    dead_paths = _means(points, length_less_count[:, None])[:, 0]
    known = identified.layout.reflectors.stop
    errors = prediction_errors(
        model.jacobian(parameters)[:, :known],
        identified.covariance[:known, :known],
        {one: moved[:known] for one, moved in identified.taken_up.items()},
        identified.budget,
        replace(model.geometry(parameters), later=True),
    )
    variance = _relative_variance(points, errors)
    deviation, u = np.full(compared.size, np.nan), np.full(compared.size, np.nan)
    deviation[compared] = dead_paths[points.dead_path] - length_less_count
    u[compared] = np.sqrt(variance)
    fitted = {key: float(value) for key, value in zip(points.dead_paths, dead_paths, strict=True)}
    probability = _probability(points, errors, deviation[compared])
    return ModelOnDistances(identified.layout.model, deviation, u, fitted, probability)


def _transferred(identified: Identification, points: Points) -> tuple[DistanceModel, Floats]:
    """Return an identified arm with its reflectors, seen through other distances with dead paths of nothing.

    What grew over the measurement that identified it stands in its middle: the path has no share of that time.
    """
    own = identified.layout
    layout = replace(own, dead_paths=points.dead_paths)
    order = np.array([own.reflector_names.index(name) for name in points.reflector_names], dtype=np.int64)
    seen = replace(points, reflector=order[points.reflector], reflector_names=own.reflector_names)
    parameters = np.zeros(layout.size)
    parameters[: own.reflectors.stop] = identified.parameters[: own.reflectors.stop]
    if any(term.source == "theta4" for term in own.terms):
        # The beam meets its reflector, so the identified places show where it was aimed.
        links, places = parameters[:2].tolist(), parameters[own.reflectors].reshape(-1, 2)
        seen = replace(seen, theta4_rad=beam_turn_rad(seen, (links[0], links[1]), places))
    design = arm_design(layout, seen.commands, seen.theta4_rad, mount_rad=seen.mount_rad)
    return DistanceModel(layout, seen, design), parameters


def _relative_variance(points: Points, errors: PredictionErrors) -> Floats:
    """Return the variance of each row minus the mean of its segment, mm², shape (n,)."""
    count = np.bincount(points.dead_path)[points.dead_path]
    effects, white = errors.effects_mm, errors.white_mm2
    shared = effects - _means(points, effects)[points.dead_path]
    mean = _means(points, white[:, None])[points.dead_path, 0]
    return np.asarray(np.sum(shared**2, axis=1) + white * (1.0 - 2.0 / count) + mean / count)


def _probability(points: Points, errors: PredictionErrors, deviation_mm: Floats) -> float | None:
    """Return the probability of deviations this large; each segment's dead path has taken its mean."""
    if not errors.white_mm2.any():
        return None
    members = points.dead_path[:, None] == np.arange(len(points.dead_paths))
    # A segment that is left out has no rows.
    used = members[:, members.any(axis=0)]
    basis = np.asarray(used / np.sqrt(used.sum(axis=0)), dtype=np.float64)
    expected = SumOfSquares.of(errors.effects_mm, errors.white_mm2, basis)
    return expected.probability(float(deviation_mm @ deviation_mm))


def _means(points: Points, values: Floats) -> Floats:
    """Return the mean over the rows of each dead path, shape (dead paths, columns)."""
    members = points.dead_path[:, None] == np.arange(len(points.dead_paths))
    return np.asarray((members.T / members.sum(axis=0)[:, None]) @ values, dtype=np.float64)
