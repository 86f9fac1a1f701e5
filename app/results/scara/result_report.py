"""Sections about identified models: parameters, maps, fit, reflectors."""

import math
from collections.abc import Sequence

import numpy as np

from catseye.app.results.figures import Figure
from catseye.app.results.model import (
    Block,
    Bullets,
    Cell,
    Column,
    Paragraph,
    Quantity,
    Section,
    Table,
    section,
)
from catseye.app.results.numbers import (
    COUNT,
    EXPANDED,
    OF_UNIT,
    PLAIN,
    PROBABILITY,
    THREE_DIGITS,
    Format,
    decimals_for,
    fixed,
    number,
)
from catseye.app.results.scara.figures.maps import map_figure
from catseye.app.results.scara.figures.residuals import pose_figure, residual_figure, residual_order_figure
from catseye.app.results.scara.fit_text import fit_statement
from catseye.app.results.scara.identified_arm import nominal_of
from catseye.app.results.scara.names import MODEL_TITLES
from catseye.app.results.scara.residuals import reference
from catseye.app.results.scara.result import Estimate, LackOfFitPart, MapTable, Result
from catseye.app.results.scara.reversal import reversal_mdeg, u_reversal_mdeg
from catseye.app.results.scara.truth_tables import TruthMap, TruthTables, normalised

_LENGTH = fixed(4)
_NORMALISED = fixed(2, signed=True)


def parameter_section(models: Sequence[Result], truth: TruthTables | None) -> Section:
    """Return links and angular offset: nominal, identified and true."""
    if not models:
        return section("parameters", "Identified arm", ())
    columns = [Column("parameter", "parameter"), Column("nominal", "nominal", format=fixed(1))]
    for model in models:
        columns += [Column(model.model, MODEL_TITLES[model.model], format=_LENGTH)]
        columns += [Column(f"{model.model}_u", "U", format=_LENGTH, standard=True)]
        if truth is not None:
            columns.append(Column(f"{model.model}_normalised", "(estimate − truth) / u", format=_NORMALISED))
    if truth is not None:
        columns.append(Column("truth", "truth", format=_LENGTH))
    nominal1_mm, nominal2_mm = nominal_of(models[0])[0]
    rows = [
        _link_row(
            "L1 / mm", nominal1_mm, [m.link1_mm for m in models], None if truth is None else truth.link1_mm
        ),
        _link_row(
            "L2 / mm", nominal2_mm, [m.link2_mm for m in models], None if truth is None else truth.link2_mm
        ),
    ]
    if any(model.model == "conventional" for model in models):
        rows.append(_offset_row(models, with_truth=truth is not None))
    table = Table("parameters", "Links and angular offset", tuple(columns), tuple(rows))
    notes = [_parameter_note(models, with_truth=truth is not None), *map(_at_reference, models)]
    return section("parameters", "Identified arm", [table, *(Paragraph(text) for text in notes if text)])


def _parameter_note(models: Sequence[Result], *, with_truth: bool) -> str:
    names = {model.model for model in models}
    note = ""
    if len(names) > 1:
        note += "The error map holds the offset of J2 in its J2 map. "
    if "conventional" in names and with_truth:
        note += (
            "The conventional model leaves out what the maps hold; that its parameters miss the truth by more than "
            "their uncertainty is a property of the model."
        )
    return note


def _at_reference(result: Result) -> str:
    """Return a sentence about the links at 20 °C, empty where the material's temperature is not known."""
    one, two = result.link1_20c_mm, result.link2_20c_mm
    if one is None or two is None or result.material_c is None:
        return ""
    return (
        f"{MODEL_TITLES[result.model]}: the links were at {number(result.material_c, fixed(2))} °C; at 20 °C they "
        f"are L1 = {number(one.value, _LENGTH)} mm (U = {number(EXPANDED * one.u, _LENGTH)} mm) and "
        f"L2 = {number(two.value, _LENGTH)} mm (U = {number(EXPANDED * two.u, _LENGTH)} mm, k = 2)."
    )


def _link_row(
    name: str, nominal: float, estimates: Sequence[Estimate], true: float | None
) -> tuple[Cell, ...]:
    form = fixed(decimals_for(estimate.u for estimate in estimates))
    row: list[Cell] = [name, nominal]
    for estimate in estimates:
        row += [Quantity(estimate.value, form), Quantity(estimate.u, form)]
        row += [] if true is None else [normalised(estimate.value, true, estimate.u)]
    return tuple(row if true is None else [*row, Quantity(true, form)])


def _offset_row(models: Sequence[Result], *, with_truth: bool) -> tuple[Cell, ...]:
    row: list[Cell] = ["θ20 / mdeg", None]
    for model in models:
        offset, form = model.theta20_mdeg, OF_UNIT["mdeg"]
        row += [None, None] if offset is None else [Quantity(offset.value, form), Quantity(offset.u, form)]
        row += [None] if with_truth else []
    return tuple([*row, None] if with_truth else row)


def map_section(result: Result | None, truth: TruthTables | None) -> Section:
    """Return figure and tables of the error maps; nothing for a model without maps."""
    blocks: list[Block | None] = []
    if result is not None and result.theta1_map is not None and result.theta2_map is not None:
        blocks = [
            map_figure(result, truth),
            _map_table(result, 1, result.theta1_map, truth.theta1_map if truth else None),
            _map_table(result, 2, result.theta2_map, truth.theta2_map if truth else None),
        ]
    return section("maps", "Error maps", blocks)


def _map_table(result: Result, joint: int, nodes: MapTable, truth: TruthMap | None) -> Table:
    decimals = decimals_for([*nodes.u_positive_mdeg, *nodes.u_negative_mdeg], fallback=2)
    form, changed = fixed(decimals), fixed(decimals, signed=True)
    u_reversal = u_reversal_mdeg(result, joint)
    columns = [Column("node_deg", "node", "°", PLAIN)]
    for key, sign in (("positive", "+"), ("negative", "−")):
        columns += [
            Column(f"{key}_mdeg", f"Δθ{joint} {sign}", format=changed),
            Column(f"u_{key}_mdeg", "U", format=form, standard=True),
        ]
        if truth is not None:
            columns += [
                Column(f"truth_{key}_mdeg", "truth", format=changed),
                Column(f"normalised_{key}", "(est. − truth) / u", format=_NORMALISED),
            ]
    columns.append(Column("reversal_mdeg", "reversal", format=changed))
    columns += [] if u_reversal is None else [Column("u_reversal_mdeg", "U", format=form, standard=True)]
    return Table(
        f"map{joint}",
        f"Map of J{joint}, mdeg, with U (k = 2)",
        tuple(columns),
        tuple(_node_row(nodes, i, truth, u_reversal) for i in range(len(nodes.node_deg))),
    )


def _node_row(
    nodes: MapTable, i: int, truth: TruthMap | None, u_reversal: list[float] | None
) -> tuple[Cell, ...]:
    node = nodes.node_deg[i]
    row: list[Cell] = [Quantity(node, COUNT if node == round(node) else fixed(3))]
    for direction, values, us in nodes.by_direction:
        row += [values[i], us[i]]
        if truth is not None:
            true = float(truth.at([node], direction)[0])
            row += [true, normalised(values[i], true, us[i])]
    row.append(reversal_mdeg(nodes)[i])
    return tuple(row if u_reversal is None else [*row, u_reversal[i]])


def fit_section(models: Sequence[Result]) -> Section:
    """Return statistics of the fits, which distances were left out, and the residuals of the last model."""
    if not models:
        return section("fit", "Quality of the fit", ())
    rejected = tuple(
        f"{MODEL_TITLES[model.model]}: {text}" for model in models for text in model.fit.rejected
    )
    judged = tuple(fit_statement(model.fit, MODEL_TITLES[model.model]).text for model in models)
    return section(
        "fit",
        "Quality of the fit",
        [
            Bullets("", judged),
            _statistics(models),
            Bullets("Left out", rejected) if rejected else None,
            *residual_figures(models[-1]),
            scatter_table(models[-1]),
        ],
    )


def _statistics(models: Sequence[Result]) -> Table:
    columns = [_fit_column(model) for model in models]
    rows: list[tuple[Cell, ...]] = [(name, *(column[name] for column in columns)) for name in columns[0]]
    return Table(
        "statistics",
        "Statistics of the fit",
        (
            Column("statistic", "statistic"),
            *(Column(model.model, MODEL_TITLES[model.model], format=COUNT) for model in models),
        ),
        tuple(row for row in rows if any(isinstance(one, Quantity) and one.value is not None for one in row)),
    )


def _fit_column(model: Result) -> dict[str, Quantity]:
    fit, expected = model.fit, reference(model.fit)
    micrometres = fixed(2)
    rows: dict[str, tuple[float | None, Format]] = {
        "distances": (fit.n_points, COUNT),
        "of them returns": (fit.n_returns, COUNT),
        "free parameters": (fit.n_parameters, COUNT),
        "degrees of freedom": (fit.dof, COUNT),
        "rms of residuals / µm": (fit.rms_um, micrometres),
        "σ of a distance, from the fit / µm": (fit.sigma0_um, micrometres),
        "σ of a distance, stated / µm": (expected.sigma_um if expected.stated else None, micrometres),
        "χ² / dof": (fit.chi2_reduced, THREE_DIGITS),
        "probability of a larger χ²": (fit.chi2_probability, PROBABILITY),
        **_lack_rows(fit.lack_of_fit),
        "uncertainties widened by": (
            math.sqrt(fit.variance_ratio) if expected.stated else None,
            THREE_DIGITS,
        ),
        "steps of the solver": (fit.iterations, COUNT),
    }
    return {name: Quantity(value, form) for name, (value, form) in rows.items()}


def _lack_rows(lack: LackOfFitPart | None) -> dict[str, tuple[float | None, Format]]:
    values: tuple[float | None, ...] = (None,) * 4
    if lack is not None:
        values = (lack.pure_um, lack.systematic_um, lack.ratio, lack.probability)
    rows = (
        ("pure scatter of repeats / µm", fixed(2)),
        ("systematic part beyond what is stated / µm", fixed(2)),
        ("lack of fit, F", THREE_DIGITS),
        ("probability of a larger F", PROBABILITY),
    )
    return {name: (value, form) for (name, form), value in zip(rows, values, strict=True)}


def scatter_table(model: Result) -> Table | None:
    """Return how far the distances to each reflector scatter about the model; None where no residuals were kept."""
    if model.residuals is None or not model.residuals.residual_um:
        return None
    values, names = np.array(model.residuals.residual_um), np.array(model.residuals.reflector)
    own = {name: values[names == name] for name in dict.fromkeys(model.residuals.reflector)}
    return Table(
        "scatter",
        "Residuals by reflector",
        (
            Column("reflector", "reflector"),
            Column("distances", "distances", format=COUNT),
            Column("rms_um", "rms", "µm", fixed(1)),
            Column("max_um", "largest", "µm", fixed(1)),
        ),
        tuple(
            (name, one.size, float(np.sqrt(np.mean(one**2))), float(np.max(np.abs(one))))
            for name, one in own.items()
        ),
    )


def residual_figures(model: Result) -> list[Figure]:
    """Return the residuals in measuring order, against the joints and per pose; none where none were kept."""
    if model.residuals is None or not model.residuals.residual_um:
        return []
    return [
        residual_order_figure(model.residuals),
        residual_figure(model.residuals, reference(model.fit), MODEL_TITLES[model.model]),
        pose_figure(model.residuals, reference(model.fit), MODEL_TITLES[model.model]),
    ]


def reflector_section(best: Result | None, truth: TruthTables | None) -> Section:
    """Return places of the reflectors and dead paths of a result."""
    title = "Reflectors and dead paths"
    if best is None:
        return section("reflectors", title, ())
    form = fixed(decimals_for(u for place in best.reflectors for u in (place.x_mm.u, place.y_mm.u)))
    return section("reflectors", title, [_places(best, truth, form), _dead_paths(best, form)])


def _places(best: Result, truth: TruthTables | None, form: Format) -> Table:
    columns = [
        Column("reflector", "reflector"),
        Column("x_mm", "x", "mm", form),
        Column("u_x_mm", "U", "mm", form, standard=True),
        Column("y_mm", "y", "mm", form),
        Column("u_y_mm", "U", "mm", form, standard=True),
    ]
    if truth is not None:
        columns += [
            Column(f"normalised_{axis}", f"({axis} − truth) / u", format=_NORMALISED) for axis in "xy"
        ]
    rows = []
    for place in best.reflectors:
        row: list[Cell] = [place.name, place.x_mm.value, place.x_mm.u, place.y_mm.value, place.y_mm.u]
        if truth is not None:
            true = truth.reflectors_mm.get(place.name, (math.nan, math.nan))
            row += [
                normalised(value.value, one, value.u)
                for value, one in zip((place.x_mm, place.y_mm), true, strict=True)
            ]
        rows.append(tuple(row))
    caption = f"Places of the reflectors ({MODEL_TITLES[best.model]})"
    return Table("reflectors", caption, tuple(columns), tuple(rows))


def _dead_paths(best: Result, form: Format) -> Table:
    return Table(
        "dead_paths",
        "Dead path of each unbroken segment",
        (
            Column("reflector", "reflector"),
            Column("segment", "segment", format=COUNT),
            Column("length_mm", "length", "mm", form),
            Column("u_mm", "U", "mm", form, standard=True),
        ),
        tuple(
            (path.reflector, path.segment, path.length_mm.value, path.length_mm.u) for path in best.dead_paths
        ),
    )
