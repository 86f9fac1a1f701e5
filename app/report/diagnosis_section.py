"""Section about what speaks for and against the fit."""

from catseye.app.analysis.diagnosis_words import Finding, coefficient_text, findings
from catseye.app.report.drawing import figure
from catseye.app.report.figures.diagnosis import harmonic_figure, order_figure, pattern_figure
from catseye.app.report.markup import Html, bullets, element, join, section, table
from catseye.app.report.numbers import NOTHING, fixed, probability, unbroken
from catseye.calibration.scara.diagnostics.diagnosis import Diagnosis
from catseye.calibration.scara.diagnostics.nested_models import ComparedModel

_SIGNS = {"good": "✓", "bad": "✗", "note": "•"}


def diagnosis_section(diagnosis: Diagnosis) -> Html:
    """Return findings, nested models, predictions of what was left out, grids of nodes, and figures.

    Args:
        diagnosis: of the error map that the page is about.
    """
    return section(
        "diagnosis",
        "Diagnosis",
        element("ul", *(_statement(one) for one in findings(diagnosis)), class_="verdict"),
        _models(diagnosis),
        _predictions(diagnosis),
        _grids(diagnosis),
        *_figures(diagnosis),
        _refused(diagnosis),
    )


def _statement(one: Finding) -> Html:
    sign = element("span", _SIGNS[one.kind], class_="sign")
    return element("li", sign, element("span", unbroken(one.text)), class_=one.kind)


def _models(diagnosis: Diagnosis) -> Html:
    head = [
        "model",
        "parameters",
        "rms / µm",
        "AICc",
        "BIC",
        "adds / µm",
        "F",
        "p, white errors",
        "p, as stated",
    ]
    rows = [_model(one) for one in diagnosis.models if not one.refused]
    terms = [
        [one.name, *coefficient_text(one, place).split(": ", 1)]
        for one in diagnosis.models[2:]
        if not one.refused and one is not diagnosis.models[-1]
        for place in range(len(one.terms))
    ]
    caption = (
        "Nested models. The error map is compared with the conventional model, all others with the error map. "
        "Probabilities count how many extensions were tried"
    )
    coefficients = (
        table("Coefficients of the extensions, each alone (k = 1)", ["model", "term", "value"], terms, 3)
        if terms
        else ""
    )
    return join([table(caption, head, rows), coefficients])


def _model(one: ComparedModel) -> list[str]:
    row = [one.name, str(one.free), fixed(one.rms_um, 2), fixed(one.aicc, 1), fixed(one.bic, 1)]
    if one.base is None:
        return row + [NOTHING] * 4
    return [
        *row,
        fixed(one.explained_um, 2),
        fixed(one.ratio, 2),
        probability(one.probability),
        probability(one.probability_stated),
    ]


def _predictions(diagnosis: Diagnosis) -> Html:
    head = ["left out", "distances", "predicted / µm", "in the fit / µm", "expected / µm"]
    rows = [
        [
            fold.name,
            str(fold.rows),
            fixed(fold.predicted_um, 1),
            fixed(fold.in_sample_um, 1),
            fixed(fold.expected_um, 1),
        ]
        for fold in diagnosis.reflectors.folds
    ]
    for one in (diagnosis.sweeps, diagnosis.segments):
        if one is not None:
            used = [fold for fold in one.folds if fold.identified and not fold.weak]
            rows.append(
                [
                    f"each {one.way} in turn ({len(used)} of {len(one.folds)})",
                    str(sum(fold.rows for fold in used)),
                    fixed(one.predicted_um, 1),
                    fixed(one.in_sample_um, 1),
                    fixed(one.expected_um, 1),
                ]
            )
    return table("What the other distances predict (rms)", head, rows)


def _grids(diagnosis: Diagnosis) -> Html:
    head = ["nodes", "parameters", "rms / µm", "AICc", "BIC", "predicted sweeps / µm"]
    rows = [
        [
            one.name,
            str(one.free),
            fixed(one.rms_um, 2),
            fixed(one.aicc, 1),
            fixed(one.bic, 1),
            fixed(one.predicted_um, 2),
        ]
        for one in diagnosis.nodes.grids
        if not one.refused
    ]
    return table("Other grids of nodes; the first one is the present one", head, rows)


def _figures(diagnosis: Diagnosis) -> list[Html]:
    drawn = [
        figure(
            order_figure(diagnosis),
            "diagnosis-order",
            "Studentised residuals in measuring order",
            "Externally studentised residuals. Dashed: what one of all distances exceeds by chance in 1 % of "
            "measurements. Dotted: a new segment; red line: a jump.",
        ),
        figure(
            pattern_figure(diagnosis),
            "diagnosis-angles",
            "Mean residuals against the joints' angles",
            "Mean residuals (predicted minus measured) against J1, J2 and the angle of the beam against link 2 (θ4). "
            "Grey: twice the standard deviation that scatter alone gives them.",
        ),
    ]
    if any(one.harmonics for one in diagnosis.harmonics):
        drawn.append(
            figure(
                harmonic_figure(diagnosis),
                "diagnosis-harmonics",
                "Harmonics that the fit leaves",
                "Standard deviation of a distance that each order would explain beyond the error map. Orders that "
                "the maps take up at these commands are not shown; of orders that are one at these commands the "
                "lowest is.",
            )
        )
    return drawn


def _refused(diagnosis: Diagnosis) -> Html:
    texts = [f"{one.name}: {one.refused}" for one in diagnosis.models if one.refused]
    texts += [f"{one.name}: {one.refused}" for one in diagnosis.nodes.grids if one.refused]
    return join([element("h3", "Not identifiable"), bullets(texts)]) if texts else Html()
