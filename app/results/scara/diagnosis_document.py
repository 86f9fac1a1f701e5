"""A diagnosis as JSON."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from catseye.app.results.figure_document import figures_json
from catseye.app.results.model import Sign, Statement
from catseye.app.results.numbers import MDEG_PER_RAD
from catseye.app.results.scara.diagnosis import coefficients, outlier_limit, outlying
from catseye.app.results.scara.diagnosis_findings import distance_text, findings
from catseye.app.results.scara.figures.diagnosis import diagnosis_figures
from catseye.calibration.core.cross_validation import CrossValidation
from catseye.calibration.scara.diagnostics.diagnosis import Diagnosis
from catseye.calibration.scara.diagnostics.harmonics import HarmonicSeries
from catseye.calibration.scara.diagnostics.joint_angles import AnglePattern
from catseye.calibration.scara.diagnostics.nested_models import ComparedModel
from catseye.calibration.scara.diagnostics.node_spacing import Grid, NodeSpacing

_KINDS = {Sign.GOOD: "good", Sign.BAD: "bad", Sign.NEUTRAL: "note", Sign.ATTENTION: "note"}


def finding_statements(found: Sequence[Mapping[str, str]]) -> list[Statement]:
    """Return the findings of a diagnosis that was written as JSON."""
    signs = {"good": Sign.GOOD, "bad": Sign.BAD, "note": Sign.NEUTRAL}
    return [Statement(signs[one["kind"]], one["text"]) for one in found]


def diagnosis_json(diagnosis: Diagnosis, names: Sequence[str]) -> dict[str, Any]:
    """Return a diagnosis as plain values; what is not a number is null.

    Args:
        diagnosis: what was found.
        names: of the runs or of the points file.
    """
    fit = diagnosis.identified.fit
    return {
        "sources": list(names),
        "findings": [{"kind": _KINDS[one.sign], "text": one.text} for one in findings(diagnosis)],
        "fit": {
            "n_points": fit.n_points,
            "n_parameters": fit.n_parameters,
            "rms_um": _number(fit.rms_um),
            "chi2_reduced": _number(fit.chi2_reduced),
            "chi2_expected": _number(fit.chi2_expected),
            "rejected": diagnosis.identified.rejected,
        },
        "models": [_model(one) for one in diagnosis.models],
        "outliers": _outliers(diagnosis),
        "changes": [
            {
                "kind": one.kind,
                "reflector": one.reflector,
                "segment": one.segment,
                "row": one.row,
                "within": one.within,
                "size_um": _number(one.size_um),
                "u_um": _number(one.u_um),
                "probability": one.probability,
                "significant": one.significant,
            }
            for one in diagnosis.changes
        ],
        "patterns": [_pattern(one) for one in diagnosis.patterns],
        "harmonics": [_series(one) for one in diagnosis.harmonics],
        "cross_validation": [
            _validation(one) for one in (diagnosis.reflectors, diagnosis.sweeps, diagnosis.segments) if one
        ],
        "nodes": _nodes(diagnosis.nodes),
        "figures": figures_json(diagnosis_figures(diagnosis)),
    }


def _number(value: float | None) -> float | None:
    return None if value is None or not math.isfinite(value) else float(value)


def _model(one: ComparedModel) -> dict[str, Any]:
    return {
        "name": one.name,
        "base": one.base,
        "refused": one.refused or None,
        "n_parameters": one.free,
        "rms_um": _number(one.rms_um),
        "aicc": _number(one.aicc),
        "bic": _number(one.bic),
        "explained_um": _number(one.explained_um),
        "f_ratio": _number(one.ratio),
        "probability": one.probability,
        "probability_stated": one.probability_stated,
        "significant": one.significant,
        "explained_by_stated": one.significant and one.explained,
        "terms": [
            {
                "name": term.name,
                "unit": "mdeg" if term.unit == "mdeg" else "um",
                "value": _number(term.value),
                "u": _number(term.u),
            }
            for term in coefficients(one)
        ],
    }


def _outliers(diagnosis: Diagnosis) -> dict[str, Any]:
    residuals, identified = diagnosis.residuals, diagnosis.identified
    influential = int(np.argmax(np.nan_to_num(residuals.cook)))
    return {
        "limit": outlier_limit(diagnosis),
        "distances": [
            {
                "row": row + 1,
                "what": distance_text(diagnosis, row),
                "residual_um": _number(1e3 * float(identified.residuals_mm[row])),
                "internal": _number(float(residuals.internal[row])),
                "external": _number(float(residuals.external[row])),
                "leverage": _number(float(residuals.leverage[row])),
                "cook": _number(float(residuals.cook[row])),
            }
            for row in outlying(diagnosis)
        ],
        "largest_leverage": _number(float(residuals.leverage.max())),
        "most_influential": {
            "row": influential + 1,
            "what": distance_text(diagnosis, influential),
            "cook": _number(float(residuals.cook[influential])),
        },
    }


def _pattern(one: AnglePattern) -> dict[str, Any]:
    return {
        "joint": one.joint,
        "angle_deg": np.round(one.angle_deg, 6).tolist(),
        "mean_um": np.round(one.mean_um, 4).tolist(),
        "count": one.count.tolist(),
        "explained_um": _number(one.explained_um),
        "f_ratio": _number(one.ratio),
        "probability": one.probability,
        "probability_stated": one.probability_stated,
    }


def _series(one: HarmonicSeries) -> dict[str, Any]:
    length = one.target == "length"
    factor = 1e3 if length else MDEG_PER_RAD
    return {
        "target": one.target,
        "source": one.source,
        "unit": "um" if length else "mdeg",
        "absorbed_orders": list(one.absorbed),
        "orders": [
            {
                "order": harmonic.order,
                "aliases": list(harmonic.aliases),
                "amplitude": factor * harmonic.amplitude,
                "u": factor * harmonic.u,
                "explained_um": harmonic.explained_um,
                "false_alarm_probability": harmonic.probability,
                "false_alarm_probability_stated": harmonic.probability_stated,
            }
            for harmonic in one.harmonics
        ],
    }


def _validation(one: CrossValidation) -> dict[str, Any]:
    return {
        "left_out": one.way,
        "predicted_um": _number(one.predicted_um),
        "in_sample_um": _number(one.in_sample_um),
        "expected_um": _number(one.expected_um),
        "folds": [
            {
                "name": fold.name,
                "distances": fold.rows,
                "identified": fold.identified,
                "predicted_um": _number(fold.predicted_um),
                "in_sample_um": _number(fold.in_sample_um),
                "expected_um": _number(fold.expected_um),
                "probability": fold.probability,
            }
            for fold in one.folds
        ],
    }


def _nodes(nodes: NodeSpacing) -> dict[str, Any]:
    best = nodes.by_prediction
    return {
        "commands_between_nodes_of_j1": nodes.between1,
        "commands_between_nodes_of_j2": nodes.between2,
        "best_aicc": nodes.by_aicc.name,
        "best_bic": nodes.by_bic.name,
        "best_prediction": None if best is None else best.name,
        "grids": [_grid(one) for one in nodes.grids],
    }


def _grid(one: Grid) -> dict[str, Any]:
    return {
        "name": one.name,
        "refused": one.refused or None,
        "n_parameters": one.free,
        "rms_um": _number(one.rms_um),
        "aicc": _number(one.aicc),
        "bic": _number(one.bic),
        "predicted_um": _number(one.predicted_um),
    }
