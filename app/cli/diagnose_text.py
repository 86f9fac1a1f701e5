"""Tables of a diagnosis."""

from collections.abc import Sequence

import numpy as np

from catseye.app.analysis.diagnosis_words import coefficient_text
from catseye.app.cli.output import table
from catseye.calibration.scara.diagnostics.diagnosis import Diagnosis
from catseye.calibration.scara.diagnostics.nested_models import ComparedModel


def tables(diagnosis: Diagnosis) -> str:
    """Return models, their coefficients, predictions and grids as tables."""
    return "\n\n".join(
        part
        for part in (
            model_table(diagnosis.models),
            _coefficients(diagnosis.models),
            _predictions(diagnosis),
            _grids(diagnosis),
        )
        if part
    )


def model_table(models: Sequence[ComparedModel]) -> str:
    """Return the nested models as a table."""
    rows = []
    for one in models:
        if one.refused:
            rows.append([one.name, "", "", "", "", "", "", "not identifiable"])
            continue
        first = one.base is None
        rows.append(
            [
                one.name,
                str(one.free),
                f"{one.rms_um:.2f}",
                f"{one.aicc:.1f}",
                f"{one.bic:.1f}",
                "" if first else f"{one.explained_um:.2f}",
                "" if first else f"{one.ratio:.2f}",
                "" if first else judged(one),
            ]
        )
    head = ["model", "parameters", "rms µm", "AICc", "BIC", "adds µm", "F", "verdict"]
    return table(head, rows)


def judged(one: ComparedModel) -> str:
    """Return whether a model adds something."""
    if not one.significant:
        return "not significant"
    return "significant, as stated contributors let expect" if one.explained else "significant"


def _coefficients(models: Sequence[ComparedModel]) -> str:
    rows = [
        [one.name, *coefficient_text(one, place).split(": ", 1)]
        for one in models
        if one.terms and not one.refused and one.name != models[-1].name
        for place in range(len(one.terms))
    ]
    return table(["model", "term", "coefficient ± u (k=1)"], rows) if rows else ""


def _predictions(diagnosis: Diagnosis) -> str:
    ways = [diagnosis.reflectors, diagnosis.sweeps, *([diagnosis.segments] if diagnosis.segments else [])]
    rows = []
    for one in ways:
        able = [fold for fold in one.folds if fold.identified and not fold.weak]
        shown = one.folds if one.way != "sweep" else ()
        rows += [
            [fold.name, str(fold.rows), *_micrometres(fold.predicted_um, fold.in_sample_um, fold.expected_um)]
            for fold in shown
        ]
        rows.append(
            [
                f"each {one.way} ({len(able)} of {len(one.folds)})",
                str(sum(fold.rows for fold in able)),
                *_micrometres(one.predicted_um, one.in_sample_um, one.expected_um),
            ]
        )
    return table(["left out", "distances", "predicted µm rms", "in the fit µm", "expected µm"], rows)


def _micrometres(*values: float) -> list[str]:
    return [f"{value:.2f}" if np.isfinite(value) else "-" for value in values]


def _grids(diagnosis: Diagnosis) -> str:
    rows = [
        [
            one.name,
            str(one.free),
            *_micrometres(one.rms_um),
            f"{one.aicc:.1f}",
            f"{one.bic:.1f}",
            *_micrometres(one.predicted_um),
        ]
        if not one.refused
        else [one.name, "", "", "", "", "not identifiable"]
        for one in diagnosis.nodes.grids
    ]
    return table(["nodes", "parameters", "rms µm", "AICc", "BIC", "predicted µm rms"], rows)
