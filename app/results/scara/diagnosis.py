"""Diagnosis of the error map of distances."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from catseye.app.results.scara.distances import DistanceSource
from catseye.app.results.scara.identify import identify_points, problem_of_points
from catseye.app.results.scara.result import term_unit
from catseye.calibration.scara.budget import Budget
from catseye.calibration.scara.diagnostics.diagnosis import Diagnosis, Progress, diagnose
from catseye.calibration.scara.diagnostics.nested_models import ComparedModel
from catseye.procedures.kit.columns import Columns
from catseye.procedures.scara.bench import ScaraBench


@dataclass(frozen=True)
class Coefficient:
    """A coefficient of a model with its standard uncertainty."""

    name: str
    value: float
    u: float
    unit: Literal["mdeg", "µm"]


def diagnose_distances(source: DistanceSource, progress: Progress = lambda _share, _text: None) -> Diagnosis:
    """Diagnose the error map of distances; see `diagnose_points`."""
    return diagnose_points(source.points, source.bench, source.stated.budget, progress)


def diagnose_points(
    points: Columns,
    bench: ScaraBench,
    budget: Budget | None,
    progress: Progress = lambda _share, _text: None,
) -> Diagnosis:
    """Diagnose the error map of distances.

    Raises:
        CalibrationError: the distances cannot determine the error map.
        ImplausibleError: the arm cannot be the one that was measured.
    """
    progress(0.0, "error map")
    found = identify_points(points, bench, "error-map", budget)
    return diagnose(problem_of_points(points, bench, "error-map", budget), progress, found)


def coefficients(model: ComparedModel) -> list[Coefficient]:
    """Return the coefficients of a model's own terms."""
    return [
        Coefficient(term.name, term_unit(term) * value, term_unit(term) * u, "mdeg" if term.angular else "µm")
        for term, value, u in zip(model.terms, model.coefficients.tolist(), model.u.tolist(), strict=True)
    ]


def outlying(diagnosis: Diagnosis) -> list[int]:
    """Return the distances beyond the limit, the farthest first."""
    size = np.abs(np.nan_to_num(diagnosis.residuals.external))
    order = np.argsort(-size)
    return [int(i) for i in order if size[i] > diagnosis.outlier_limit]
