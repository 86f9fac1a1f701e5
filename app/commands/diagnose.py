"""diagnose: what speaks for and against a fit."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from catseye.app.analysis.diagnosing import diagnose_distances, diagnosis_json
from catseye.app.analysis.diagnosis_words import coefficient_text, findings
from catseye.app.analysis.distance_source import load_distances
from catseye.app.commands.output import emit, emit_json, say, table
from catseye.app.commands.progress import ProgressBar
from catseye.calibration.scara.diagnostics.diagnosis import Diagnosis
from catseye.calibration.scara.diagnostics.nested_models import ComparedModel

_SIGNS = {"good": "ok   ", "bad": "LOOK ", "note": "note "}

_STEPS = 20
"""About how many steps a diagnosis tells of; the bar need not be exact."""


def diagnose_command(
    run: list[str], points: Path | None, cell: Path | None, runs: Path | None, as_json: bool
) -> None:
    """Diagnose and tell."""
    source = load_distances(run, points, cell, runs)
    for text in source.warnings:
        say(text)
    bar, step = ProgressBar("diagnose"), iter(range(1, 1000))
    try:
        diagnosis = diagnose_distances(
            source, lambda text: bar.update(min(next(step), _STEPS - 1), _STEPS, text)
        )
        bar.update(_STEPS, _STEPS, "done")
    finally:
        bar.close()
    if as_json:
        emit_json(diagnosis_json(diagnosis, source.names))
        return
    emit(tables(diagnosis))
    for text in diagnosis.identified.rejected:
        say(f"left out: {text}")
    emit("")
    for one in findings(diagnosis):
        emit(_SIGNS[one.kind] + one.text)


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
