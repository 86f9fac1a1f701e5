"""Everything that speaks for or against a fit, in one pass."""

from collections.abc import Callable
from dataclasses import dataclass

from catseye.calibration.core.cross_validation import CrossValidation
from catseye.calibration.core.residuals import StudentisedResiduals, studentised
from catseye.calibration.scara.diagnostics.drift import Change, changes
from catseye.calibration.scara.diagnostics.folds import cross_validation
from catseye.calibration.scara.diagnostics.harmonics import Harmonic, HarmonicSeries, harmonic_series
from catseye.calibration.scara.diagnostics.joint_angles import AnglePattern, angle_patterns
from catseye.calibration.scara.diagnostics.nested_models import ComparedModel, Extension, compare_models
from catseye.calibration.scara.diagnostics.node_spacing import NodeSpacing, node_spacing
from catseye.calibration.scara.diagnostics.problem import Problem
from catseye.calibration.scara.diagnostics.projection import projection_of
from catseye.calibration.scara.extension import crosstalk, j4_map, periodic, thermal_drift
from catseye.calibration.scara.identification import Identification

_MOST_ORDERS = 3
"""Harmonics of a joint that are tried as terms of a model."""


@dataclass(frozen=True)
class Diagnosis:
    """What was found about the error map of an arm.

    Attributes:
        identified: the error map itself.
        residuals: studentised residuals of its distances.
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
    residuals: StudentisedResiduals
    changes: list[Change]
    patterns: list[AnglePattern]
    harmonics: list[HarmonicSeries]
    reflectors: CrossValidation
    sweeps: CrossValidation
    segments: CrossValidation | None
    models: list[ComparedModel]
    nodes: NodeSpacing


def diagnose(problem: Problem, progress: Callable[[str], None] = lambda _: None) -> Diagnosis:
    """Look at a fit from all sides.

    Args:
        progress: called with what comes next.

    Raises:
        CalibrationError: the error map cannot be identified.
    """
    progress("error map")
    identified = problem.solve()
    points = identified.points
    kept = [problem.points.reflector_names.index(name) for name in points.reflector_names]
    aimed = ((problem.link1_mm, problem.link2_mm), problem.reflectors_mm[kept])
    projection = projection_of(identified)
    progress("harmonics")
    harmonics = harmonic_series(projection, *aimed)
    progress("drift and jumps")
    changed = changes(projection)
    progress("cross-validation")
    several = len(points.dead_paths) > len(points.reflector_names)
    return Diagnosis(
        identified=identified,
        residuals=studentised(projection, stated=points.sigma_mm is not None),
        changes=changed,
        patterns=angle_patterns(projection, *aimed),
        harmonics=harmonics,
        reflectors=cross_validation(projection, "reflector"),
        sweeps=cross_validation(projection, "sweep"),
        segments=cross_validation(projection, "segment") if several else None,
        models=compare_models(problem, extensions(harmonics), progress),
        nodes=node_spacing(problem, progress),
    )


def extensions(harmonics: list[HarmonicSeries]) -> list[Extension]:
    """Return what is tried beyond the maps: crosstalk, J4 map, thermal drift, and the periodic orders found."""
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
            tried.append(
                Extension(f"periodic J{joint}, order {listed}", periodic(1 if joint == 1 else 2, orders))
            )
    return tried


def _clearest(series: HarmonicSeries) -> list[Harmonic]:
    found = [one for one in series.harmonics if one.significant]
    return sorted(found, key=lambda one: -one.explained_um)[:_MOST_ORDERS]
