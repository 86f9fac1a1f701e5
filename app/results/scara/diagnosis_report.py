"""What speaks for and against a fit: findings, nested models, predictions of what was left out, grids, figures."""

from collections.abc import Sequence

from catseye.app.results.model import Bullets, Cell, Column, Origin, Report, Section, Table, section
from catseye.app.results.numbers import COUNT, PROBABILITY, fixed
from catseye.app.results.scara.diagnosis import coefficients
from catseye.app.results.scara.diagnosis_findings import findings
from catseye.app.results.scara.figures.diagnosis import diagnosis_figures
from catseye.calibration.core.cross_validation import CrossValidation
from catseye.calibration.scara.diagnostics.diagnosis import Diagnosis
from catseye.calibration.scara.diagnostics.nested_models import ComparedModel
from catseye.calibration.scara.diagnostics.node_spacing import Grid

_UM, _CRITERION = fixed(2), fixed(1)
_NOT_IDENTIFIABLE = "not identifiable"


def diagnosis_report(diagnosis: Diagnosis, origin: Origin) -> Report:
    """Return what a diagnosis says."""
    return Report("Diagnosis", origin, (diagnosis_section(diagnosis),))


def diagnosis_section(diagnosis: Diagnosis | None) -> Section:
    """Return findings, tables and figures; empty without a diagnosis."""
    if diagnosis is None:
        return section("diagnosis", "Diagnosis", ())
    refused = [(model.name, model.refused) for model in diagnosis.models]
    refused += [(grid.name, grid.refused) for grid in diagnosis.nodes.grids]
    texts = tuple(f"{name}: {why}" for name, why in refused if why)
    return section(
        "diagnosis",
        "Diagnosis",
        [
            *findings(diagnosis),
            _models(diagnosis.models),
            _coefficients(diagnosis.models),
            _predictions(diagnosis),
            _grids(diagnosis.nodes.grids),
            *diagnosis_figures(diagnosis),
            Bullets("Not identifiable", texts) if texts else None,
        ],
        brief=True,
    )


def _models(models: Sequence[ComparedModel]) -> Table:
    return Table(
        "models",
        "Nested models beside all stated errors. The error map is compared with the conventional model, all others "
        "with the error map. Probabilities count all checks of the diagnosis; as stated: it is there, and no larger "
        "than the stated errors make it",
        (
            Column("name", "model"),
            Column("n_parameters", "parameters", format=COUNT),
            Column("rms_um", "rms", "µm", _UM),
            Column("aicc", "AICc", format=_CRITERION),
            Column("bic", "BIC", format=_CRITERION),
            Column("explained_um", "adds", "µm", _UM),
            Column("f_ratio", "F", format=fixed(2)),
            Column("probability", "p", format=PROBABILITY),
            Column("verdict", "verdict"),
        ),
        tuple(_model(model) for model in models),
    )


def _model(model: ComparedModel) -> tuple[Cell, ...]:
    if model.refused:
        return (model.name, *[None] * 7, _NOT_IDENTIFIABLE)
    row = (model.name, model.n_parameters, model.rms_um, model.aicc, model.bic)
    if model.base is None:
        return (*row, *[None] * 3, "")
    return (
        *row,
        model.explained_um,
        model.ratio,
        model.probability,
        _judged(model),
    )


def _judged(model: ComparedModel) -> str:
    if model.as_stated:
        return "as stated"
    return "significant" if model.significant else "not significant"


def _coefficients(models: Sequence[ComparedModel]) -> Table | None:
    """Return the coefficients of all but the last model, which holds those of all others together."""
    rows = tuple(
        (one.name, term.name, term.value, term.u, term.unit)
        for one in models[:-1]
        if not one.refused
        for term in coefficients(one)
    )
    columns = (
        Column("model", "model"),
        Column("term", "term"),
        Column("value", "value", format=fixed(2)),
        Column("u", "U (k=2)", format=fixed(2), standard=True),
        Column("unit", "unit"),
    )
    caption = "Coefficients of the extensions, each alone"
    return Table("coefficients", caption, columns, rows) if rows else None


def _predictions(diagnosis: Diagnosis) -> Table:
    ways = [way for way in (diagnosis.reflectors, diagnosis.sweeps, diagnosis.segments) if way]
    return Table(
        "predictions",
        "What the other distances predict (rms)",
        (
            Column("left_out", "left out"),
            Column("distances", "distances", format=COUNT),
            Column("predicted_um", "predicted", "µm", _UM),
            Column("in_sample_um", "in the fit", "µm", _UM),
            Column("expected_um", "expected", "µm", _UM),
        ),
        tuple(row for way in ways for row in _left_out(way)),
    )


def _left_out(validation: CrossValidation) -> list[tuple[Cell, ...]]:
    """Return a row for each part that was left out, and one for all; sweeps are too many to be listed."""
    used = [fold for fold in validation.folds if fold.identified and not fold.weak]
    rows: list[tuple[Cell, ...]] = [
        (fold.name, fold.rows, fold.predicted_um, fold.in_sample_um, fold.expected_um)
        for fold in (validation.folds if validation.way != "sweep" else ())
    ]
    name = f"each {validation.way} in turn ({len(used)} of {len(validation.folds)})"
    count = sum(fold.rows for fold in used)
    return [*rows, (name, count, validation.predicted_um, validation.in_sample_um, validation.expected_um)]


def _grids(grids: Sequence[Grid]) -> Table:
    return Table(
        "grids",
        "Other grids of nodes; the first one is the present one",
        (
            Column("name", "nodes"),
            Column("n_parameters", "parameters", format=COUNT),
            Column("rms_um", "rms", "µm", _UM),
            Column("aicc", "AICc", format=_CRITERION),
            Column("bic", "BIC", format=_CRITERION),
            Column("predicted_um", "predicted sweeps", "µm", _UM),
            Column("verdict", ""),
        ),
        tuple(
            (grid.name, *[None] * 5, _NOT_IDENTIFIABLE)
            if grid.refused
            else (grid.name, grid.n_parameters, grid.rms_um, grid.aicc, grid.bic, grid.predicted_um, "")
            for grid in grids
        ),
    )
