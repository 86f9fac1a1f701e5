"""diagnose: what speaks for and against a fit."""

from catseye.app.cli.options import AsJson, MeasuredRuns, PointsCell, PointsFile, Runs
from catseye.app.cli.output import emit, emit_json, say
from catseye.app.cli.progress import ProgressBar

_SIGNS = {"good": "ok   ", "bad": "LOOK ", "note": "note "}

_STEPS = 20
"""About how many steps a diagnosis tells of; the bar need not be exact."""


def diagnose(
    run: MeasuredRuns = None,
    points: PointsFile = None,
    cell: PointsCell = None,
    runs: Runs = None,
    as_json: AsJson = False,
) -> None:
    """Tell what speaks against a fit: outliers, drift, lack of fit, cross-validation, richer models, node spacing.

    Example: catseye diagnose 1a2b3c
    """
    from catseye.app.analysis.diagnosing import diagnose_distances, diagnosis_json
    from catseye.app.analysis.diagnosis_words import findings
    from catseye.app.analysis.distance_source import load_distances
    from catseye.app.cli.diagnose_text import tables

    source = load_distances(run or [], points, cell, runs)
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
