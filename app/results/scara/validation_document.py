"""A validation as numbers, for machines."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from catseye.app.results.figure_document import figures_json
from catseye.app.results.figures import Figure
from catseye.app.results.numbers import MDEG_PER_RAD
from catseye.app.results.scara.path_view import model_title, path_axis, there
from catseye.app.results.scara.validation import ModelOnPath
from catseye.app.results.scara.validation_of_files import FileValidation
from catseye.app.results.scara.validation_text import agreement_text


def validation_facts(
    found: FileValidation, limit_um: float | None, figures: Sequence[Figure]
) -> dict[str, Any]:
    """Return everything that a validation tells.

    Args:
        found: what was compared.
        limit_um: 2-D rms that may be left.
        figures: of the path.
    """
    validation = found.validation
    left_um = validation.models[-1].comparison.rms_2d_um
    return {
        "rows": int(validation.compared.size),
        "compared": int(validation.compared.sum()),
        "left_out": found.left_out,
        "warnings": found.remarks,
        "models": [model_facts(model, found) for model in validation.models],
        "ratio": validation.ratio,
        "limit_um": limit_um,
        "within_limit": None if limit_um is None else left_um <= limit_um,
        "iso230_2": [
            {
                "joint": one.joint,
                "symbol": quantity.symbol,
                "name": quantity.name,
                "value_mdeg": quantity.value,
                "u_mdeg": quantity.u,
                "excess_mdeg": quantity.excess,
            }
            for one in found.maps
            for quantity in one.quantities()
        ],
        "iso9283": _repeat_facts(found),
        "path": _path_facts(found),
        "verdict": [agreement_text(model) for model in validation.models],
        "figures": figures_json(figures),
    }


def model_facts(model: ModelOnPath, found: FileValidation) -> dict[str, Any]:
    """Return what a validation tells about one of its models."""
    comparison, judged = model.comparison, model.agreement
    first_um = found.validation.models[0].comparison.rms_2d_um
    rms_x, rms_y = comparison.rms_um
    shift = [
        {"value": float(value), "u": float(u)}
        for value, u in zip(comparison.transform.shift_mm, judged.u_shift_mm, strict=True)
    ]
    return {
        "model": model.model,
        "title": model_title(model),
        "alignment": {
            "rotation_mdeg": {
                "value": MDEG_PER_RAD * comparison.transform.rotation_rad,
                "u": MDEG_PER_RAD * judged.u_rotation_rad,
            },
            "shift_x_mm": shift[0],
            "shift_y_mm": shift[1],
        },
        "rms_x_um": rms_x,
        "rms_y_um": rms_y,
        "rms_um": comparison.rms_2d_um,
        "max_um": comparison.max_um,
        "max_line": found.lines[comparison.worst],
        "ratio": comparison.rms_2d_um / first_um if first_um > 0.0 else 1.0,
        "median_u_um": model.median_u_um,
        "expected_um": judged.expected_um,
        "share_explained": judged.share if math.isfinite(judged.share) else None,
        "within_2u": None if math.isnan(judged.within) else judged.within,
        "probability": judged.probability,
    }


def _path_facts(found: FileValidation) -> dict[str, Any]:
    """Return the compared rows along the path: what was measured and what each model predicts.

    The measurement is aligned to the last model; the predictions of another one are in that frame too, so that
    measured minus predicted is what this model leaves after its own alignment.
    """
    validation = found.validation
    axis, rows = path_axis(validation.path), validation.compared
    measured_mm = validation.models[-1].comparison.measured_error_mm[rows]
    left_mm = [model.comparison.difference_mm[rows] for model in validation.models]
    return {
        "axis": axis.label,
        "axis_mm": axis.values_mm[rows].tolist(),
        "line": [line for line, compared in zip(found.lines, rows.tolist(), strict=True) if compared],
        "way_there": there(validation.path)[rows].tolist(),
        "models": [model_title(model) for model in validation.models],
        "deviations": [
            {
                "symbol": symbol.replace("{", "").replace("}", ""),
                "what": what,
                "measured_um": (1e3 * measured_mm[:, component]).tolist(),
                "predicted_um": [
                    (1e3 * (measured_mm[:, component] - left[:, component])).tolist() for left in left_mm
                ],
            }
            for symbol, what, component in axis.deviations
        ],
    }


def _repeat_facts(found: FileValidation) -> list[dict[str, Any]]:
    path, repeats = found.validation.path, found.repeats
    return [
        {
            "theta1_deg": float(np.rad2deg(path.commands.theta1_rad[row])),
            "theta2_deg": float(np.rad2deg(path.commands.theta2_rad[row])),
            "direction1": int(path.commands.direction1[row]),
            "direction2": int(path.commands.direction2[row]),
            "n": one.n,
            "ap_um": 1e3 * one.accuracy,
            "rp_um": 1e3 * one.repeatability,
            "ap_to_model_um": None if math.isnan(off) else 1e3 * float(off),
        }
        for row, one, off in zip(repeats.rows, repeats.poses, repeats.model_mm, strict=True)
    ]
