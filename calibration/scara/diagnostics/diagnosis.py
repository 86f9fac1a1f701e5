"""Everything that speaks for or against a fit, in one pass."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

from catseye.calibration.core.cross_validation import CrossValidation, Fold
from catseye.calibration.core.residuals import (
    StudentisedResiduals,
    outlier_limit,
    outlier_probability,
    studentised,
)
from catseye.calibration.core.significance import SIGNIFICANCE, holm_factors
from catseye.calibration.scara.diagnostics.drift import Change, changes
from catseye.calibration.scara.diagnostics.folds import cross_validation
from catseye.calibration.scara.diagnostics.harmonics import Harmonic, HarmonicSeries, harmonic_series
from catseye.calibration.scara.diagnostics.joint_angles import AnglePattern, angle_patterns
from catseye.calibration.scara.diagnostics.nested_models import (
    TOGETHER,
    ComparedModel,
    Extension,
    compare_models,
)
from catseye.calibration.scara.diagnostics.node_spacing import NodeSpacing, node_spacing
from catseye.calibration.scara.diagnostics.problem import Problem
from catseye.calibration.scara.diagnostics.projection import projection_of
from catseye.calibration.scara.extension import crosstalk, j4_map, periodic, thermal_drift
from catseye.calibration.scara.identification import Identification

_USUAL_GRIDS = 9
"""Grids that are tried where commands stand on the nodes."""

_MOST_ORDERS = 3
"""Harmonics of a joint that are tried as terms of a model."""


_Check = TypeVar("_Check", AnglePattern, Change, ComparedModel, Fold, Harmonic)


@dataclass(frozen=True)
class Diagnosis:
    """What was found about the error map of an arm.

    All probabilities are corrected for all that was looked at.

    Attributes:
        identified: the error map itself.
        misfit: probability of a χ² this large; None where no uncertainty is stated.
        residuals: studentised residuals of its distances.
        outlier_limit: studentised residual beyond which a distance stands out.
        changes: drifts and jumps.
        patterns: residuals against the joints' angles.
        harmonics: orders that are left over.
        reflectors: reflectors left out in turn.
        sweeps: sweeps of J2 left out in turn.
        segments: segments left out in turn; None where each reflector has one.
        models: nested models, the smallest first.
        nodes: grids of nodes.
    """

    identified: Identification
    misfit: float | None
    residuals: StudentisedResiduals
    outlier_limit: float
    changes: list[Change]
    patterns: list[AnglePattern]
    harmonics: list[HarmonicSeries]
    reflectors: CrossValidation
    sweeps: CrossValidation
    segments: CrossValidation | None
    models: list[ComparedModel]
    nodes: NodeSpacing


Progress = Callable[[float, str], None]
"""Called with the share of the work that is done, and with what comes next."""


def diagnose(
    problem: Problem,
    progress: Progress = lambda _share, _text: None,
    identified: Identification | None = None,
) -> Diagnosis:
    """Look at a fit from all sides.

    Args:
        identified: what the problem's solution is, where it is known.

    Raises:
        CalibrationError: the error map cannot be identified.
    """
    progress(0.0, "error map")
    found = problem.solve() if identified is None else identified
    points = found.points
    aimed = ((problem.link1_mm, problem.link2_mm), problem.rough_places(points))
    projection = projection_of(found)
    progress(0.15, "harmonics")
    harmonics = harmonic_series(projection, *aimed)
    progress(0.4, "drift and jumps")
    changed = changes(projection)
    progress(0.45, "cross-validation")
    several = len(points.dead_paths) > len(points.reflector_names)
    ways = [cross_validation(projection, way) for way in ("reflector", "sweep")]
    segments = cross_validation(projection, "segment") if several else None
    tried = extensions(harmonics)
    models = compare_models(problem, tried, _stage(progress, (0.55, 0.75), len(tried) + 3), found)
    return corrected_together(
        Diagnosis(
            identified=found,
            misfit=found.fit.chi2_probability,
            residuals=studentised(projection, stated=points.sigma_mm is not None),
            outlier_limit=outlier_limit(len(points), projection.dof, SIGNIFICANCE),
            changes=changed,
            patterns=angle_patterns(projection, *aimed),
            harmonics=harmonics,
            reflectors=ways[0],
            sweeps=ways[1],
            segments=segments,
            models=models,
            nodes=node_spacing(problem, _stage(progress, (0.75, 1.0), _USUAL_GRIDS), found),
        )
    )


def _stage(progress: Progress, shares: tuple[float, float], steps: int) -> Callable[[str], None]:
    """Return the progress of a stage of about so many steps between two shares of the whole."""
    step, (first, last) = iter(range(steps)), shares
    return lambda text: progress(first + (last - first) * next(step, steps - 1) / steps, text)


def corrected_together(found: Diagnosis) -> Diagnosis:
    """Return a diagnosis whose probabilities count all checks (Holm), so that a sound fit raises few alarms.

    Each check comes with probabilities that count what it looked at itself.
    """
    dof, external = found.identified.fit.dof, found.residuals.external
    folds = [one.folds for one in (found.reflectors, found.sweeps, found.segments) if one is not None]
    families: list[Sequence[float]] = [
        [1.0 if found.misfit is None else found.misfit],
        [outlier_probability(external, dof)],
        [one.probability for one in found.changes],
        [one.probability for one in found.patterns],
        [one.probability for series in found.harmonics for one in series.harmonics],
        [one.probability for one in found.models if one.terms and one.name != TOGETHER],
        *([one.probability for one in group] for group in folds),
    ]
    factors = holm_factors([min(family, default=1.0) for family in families])
    misfit, outlier, change, pattern, harmonic, model, *left_out = factors
    validations = [
        replace(one, folds=tuple(_raised(one.folds, factor)))
        for one, factor in zip((found.reflectors, found.sweeps, found.segments), left_out, strict=False)
        if one is not None
    ]
    return replace(
        found,
        misfit=None if found.misfit is None else min(1.0, misfit * found.misfit),
        outlier_limit=outlier_limit(external.size, dof, SIGNIFICANCE / outlier),
        changes=_raised(found.changes, change),
        patterns=_raised(found.patterns, pattern),
        harmonics=[
            replace(one, harmonics=tuple(_raised(one.harmonics, harmonic))) for one in found.harmonics
        ],
        reflectors=validations[0],
        sweeps=validations[1],
        segments=validations[2] if found.segments is not None else None,
        models=[_raised_model(one, model) for one in found.models],
    )


def _raised(checks: Sequence[_Check], factor: float) -> list[_Check]:
    return [replace(one, probability=min(1.0, factor * one.probability)) for one in checks]


def _raised_model(one: ComparedModel, factor: float) -> ComparedModel:
    """Return a model with its probability raised; that the maps are needed is no alarm."""
    if not one.terms:
        return one
    raised = replace(one, alone=min(1.0, factor * one.alone))
    return _raised([raised], factor)[0]


def extensions(harmonics: list[HarmonicSeries]) -> list[Extension]:
    """Return what is tried beyond the maps: crosstalk, J4 map, thermal drift, and the periodic orders found."""
    looked_at = float(sum(len(one.harmonics) for one in harmonics))
    tried = [
        Extension("J1–J2 crosstalk", crosstalk()),
        Extension("J4 map", j4_map()),
        Extension("thermal drift", thermal_drift()),
    ]
    for joint, target in ((1, "theta1"), (2, "theta2")):
        series = next(one for one in harmonics if one.target == target and one.source == target)
        orders = tuple(sorted(one.order for one in _clearest(series)))
        if orders:
            listed = ", ".join(str(order) for order in orders)
            terms = periodic(1 if joint == 1 else 2, orders)
            name = f"periodic J{joint}, order {listed}"
            tried.append(Extension(name, terms, chosen_from=looked_at ** len(orders)))
    return tried


def _clearest(series: HarmonicSeries) -> list[Harmonic]:
    found = [one for one in series.harmonics if one.significant]
    return sorted(found, key=lambda one: -one.explained_um)[:_MOST_ORDERS]
