"""Sections about identified models: parameters, maps, fit, reflectors."""

import math
from collections.abc import Sequence

from catseye.app.files.identified_arm import nominal_of
from catseye.app.files.result_json import Estimate, MapTable, Result
from catseye.app.render.drawing import figure
from catseye.app.render.markup import Html, bullets, element, join, paragraphs, section, table
from catseye.app.results.numbers import (
    NOTHING,
    decimals_for,
    fixd,
    probability_text,
    signd,
    three_digits,
)
from catseye.app.results.scara.agreement import normalised
from catseye.app.results.scara.content import MODEL_TITLES, ReportContent, TruthMap
from catseye.app.results.scara.figures.maps import error_map_figure
from catseye.app.results.scara.figures.residuals import residual_figure
from catseye.app.results.scara.residuals import reference
from catseye.app.results.scara.reversal import reversal_mdeg, u_reversal_mdeg
from catseye.app.results.scara.verdict import fit_verdict


def models_of(content: ReportContent) -> list[Result]:
    """Return the conventional model and the error map, as far as they are there."""
    return [result for result in (content.conventional, content.error_map) if result is not None]


def parameter_section(content: ReportContent) -> Html:
    """Return links and angular offset, nominal, identified and true."""
    models = models_of(content)
    if not models:
        return Html()
    head = ["parameter", "nominal"]
    for model in models:
        head += [MODEL_TITLES[model.model], "u"]
        head += [] if content.truth is None else ["(estimate − truth) / u"]
    head += [] if content.truth is None else ["truth"]
    (nominal1_mm, nominal2_mm), truth = nominal_of(models[0])[0], content.truth
    links = (
        ("L1 / mm", nominal1_mm, [m.link1_mm for m in models], truth.link1_mm if truth else None),
        ("L2 / mm", nominal2_mm, [m.link2_mm for m in models], truth.link2_mm if truth else None),
    )
    rows = [_link_row(*link) for link in links]
    if content.conventional is not None:
        rows.append(_offset_row(models, truth is not None))
    note = "u is the standard uncertainty (k = 1). "
    if content.error_map is not None and content.conventional is not None:
        note += "The error map holds the offset of J2 in its J2 map. "
    if content.conventional is not None and truth is not None:
        note += (
            "The conventional model leaves out what the maps hold; that its parameters miss the truth by more than "
            "their uncertainty is a property of the model."
        )
    return section(
        "parameters",
        "Identified arm",
        table("Links and angular offset", head, rows),
        paragraphs(note, *(_at_reference(model) for model in models)),
    )


def _at_reference(result: Result) -> str:
    """Return a sentence about the links at 20 °C, empty where the material's temperature is not known."""
    one, two = result.link1_20c_mm, result.link2_20c_mm
    if one is None or two is None or result.material_c is None:
        return ""
    return (
        f"{MODEL_TITLES[result.model]}: the links had {fixd(result.material_c, 2)} °C; at 20 °C they are "
        f"L1 = {fixd(one.value, 4)} mm (u = {fixd(one.u, 4)} mm) and L2 = {fixd(two.value, 4)} mm "
        f"(u = {fixd(two.u, 4)} mm)."
    )


def _link_row(name: str, nominal: float, estimates: Sequence[Estimate], true: float | None) -> list[str]:
    decimals = decimals_for(estimate.u for estimate in estimates)
    row = [name, fixd(nominal, 1)]
    for estimate in estimates:
        row += [fixd(estimate.value, decimals), fixd(estimate.u, decimals)]
        row += [] if true is None else [signd(normalised(estimate.value, true, estimate.u), 2)]
    return row if true is None else [*row, fixd(true, decimals)]


def _offset_row(models: Sequence[Result], with_truth: bool) -> list[str]:
    row = ["θ20 / mdeg", NOTHING]
    for model in models:
        offset = model.theta20_mdeg
        row += [NOTHING, NOTHING] if offset is None else [fixd(offset.value, 2), fixd(offset.u, 2)]
        row += [NOTHING] if with_truth else []
    return [*row, NOTHING] if with_truth else row


def map_section(content: ReportContent) -> Html:
    """Return figure and tables of the error maps."""
    result = content.error_map
    if result is None or result.theta1_map is None or result.theta2_map is None:
        return Html()
    caption = (
        "Angular positioning deviation (actual minus command) of both joints. ▲ red: positive direction, ▼ blue: "
        "negative direction; error bars: standard uncertainty (k = 1). Below: reversal error, negative minus "
        "positive."
    )
    if content.truth is not None:
        caption += " Thin black lines: truth of the emulated bench, solid for positive, dashed for negative."
    truth = content.truth
    return section(
        "maps",
        "Error maps",
        figure(error_map_figure(result, truth), "maps", "Error maps of J1 and J2", caption),
        _map_table(result, 1, result.theta1_map, truth.theta1_map if truth else None),
        _map_table(result, 2, result.theta2_map, truth.theta2_map if truth else None),
    )


def _map_table(result: Result, joint: int, nodes: MapTable, truth: TruthMap | None) -> Html:
    decimals = decimals_for([*nodes.u_positive_mdeg, *nodes.u_negative_mdeg], fallback=2)
    u_reversal = u_reversal_mdeg(result, joint)
    head = ["node / °"]
    for sign in "+−":
        head += [f"Δθ{joint} {sign}", "u"] + ([] if truth is None else ["truth", "(est. − truth) / u"])
    head += ["reversal", *([] if u_reversal is None else ["u"])]
    rows = []
    for i, node in enumerate(nodes.node_deg):
        row = [fixd(node, 0 if node == round(node) else 3)]
        for direction, values, us in (
            (1, nodes.positive_mdeg, nodes.u_positive_mdeg),
            (-1, nodes.negative_mdeg, nodes.u_negative_mdeg),
        ):
            row += [signd(values[i], decimals), fixd(us[i], decimals)]
            if truth is not None:
                true = float(truth.at([node], direction)[0])
                row += [signd(true, decimals), signd(normalised(values[i], true, us[i]), 2)]
        row.append(signd(reversal_mdeg(nodes)[i], decimals))
        row += [] if u_reversal is None else [fixd(u_reversal[i], decimals)]
        rows.append(row)
    return table(f"Map of J{joint}, mdeg, with standard uncertainties (k = 1)", head, rows)


def fit_section(content: ReportContent) -> Html:
    """Return statistics of the fits, what was rejected, and the residuals of the best model."""
    models = models_of(content)
    if not models:
        return Html()
    head = ["statistic", *(MODEL_TITLES[model.model] for model in models)]
    columns = [_statistics(model) for model in models]
    rows = [[name, *(column[name] for column in columns)] for name in columns[0]]
    rows = [row for row in rows if any(cell != NOTHING for cell in row[1:])]
    rejected = [f"{MODEL_TITLES[model.model]}: {text}" for model in models for text in model.fit.rejected]
    return section(
        "fit",
        "Quality of the fit",
        bullets(fit_verdict(model).text for model in models),
        table("Statistics of the fit", head, rows),
        join([element("h3", "Left out"), bullets(rejected)]) if rejected else "",
        _residuals(models[-1]),
    )


def _statistics(model: Result) -> dict[str, str]:
    fit, lack = model.fit, model.fit.lack_of_fit
    expected = reference(fit)
    return {
        "distances": str(fit.n_points),
        "free parameters": str(fit.n_parameters),
        "degrees of freedom": str(fit.dof),
        "rms of residuals / µm": fixd(fit.rms_um, 2),
        "σ of a distance, from the fit / µm": fixd(fit.sigma0_um, 2),
        "σ of a distance, stated / µm": fixd(expected.sigma_um, 2) if expected.stated else NOTHING,
        "χ² / dof": NOTHING if fit.chi2_reduced is None else three_digits(fit.chi2_reduced),
        "χ² / dof expected of what was stated": NOTHING
        if fit.chi2_reduced is None
        else three_digits(fit.chi2_expected),
        "probability of a larger χ²": NOTHING
        if fit.chi2_probability is None
        else probability_text(fit.chi2_probability),
        "pure scatter of repeats / µm": NOTHING if lack is None else fixd(lack.pure_um, 2),
        "systematic part / µm": NOTHING if lack is None else fixd(lack.systematic_um, 2),
        "lack of fit, F": NOTHING if lack is None else three_digits(lack.ratio),
        "F expected of what was stated": NOTHING if lack is None else three_digits(lack.expected_ratio),
        "probability of a larger F, white errors": NOTHING
        if lack is None
        else probability_text(lack.probability),
        "probability of a larger F, as stated": NOTHING
        if lack is None
        else probability_text(lack.probability_stated),
        "uncertainties widened by": three_digits(math.sqrt(fit.variance_factor))
        if expected.stated
        else NOTHING,
        "steps of the solver": str(fit.iterations),
    }


def _residuals(model: Result) -> Html:
    if model.residuals is None or not model.residuals.residual_um:
        return Html()
    caption = (
        f"Residuals (predicted minus measured) of the {MODEL_TITLES[model.model]}. a), b): dots are distances, "
        "larger markers are means per node and reflector. e) and on: means over the repeats of a pose; a pattern "
        "there that exceeds the scatter is what the model lacks."
    )
    drawn = residual_figure(model.residuals, reference(model.fit))
    return figure(drawn, "residuals", "Residuals of the fit", caption)


def reflector_section(content: ReportContent) -> Html:
    """Return places of the reflectors and dead paths of the best model."""
    best = content.best
    if best is None:
        return Html()
    truth = content.truth if best.model == "error-map" else None
    decimals = decimals_for(u for place in best.reflectors for u in (place.x_mm.u, place.y_mm.u))
    head = ["reflector", "x / mm", "u / mm", "y / mm", "u / mm"]
    head += [] if truth is None else ["(x − truth) / u", "(y − truth) / u"]
    rows = []
    for place in best.reflectors:
        row = [place.name]
        for value in (place.x_mm, place.y_mm):
            row += [fixd(value.value, decimals), fixd(value.u, decimals)]
        if truth is not None:
            true = truth.reflectors_mm.get(place.name, (math.nan, math.nan))
            row += [
                signd(normalised(value.value, one, value.u), 2)
                for value, one in zip((place.x_mm, place.y_mm), true, strict=True)
            ]
        rows.append(row)
    paths = [
        [
            path.reflector,
            str(path.segment),
            fixd(path.length_mm.value, decimals),
            fixd(path.length_mm.u, decimals),
        ]
        for path in best.dead_paths
    ]
    return section(
        "reflectors",
        "Reflectors and dead paths",
        table(f"Places of the reflectors ({MODEL_TITLES[best.model]})", head, rows),
        table("Dead path of each unbroken segment", ["reflector", "segment", "length / mm", "u / mm"], paths),
    )
