"""What models leave on a validation path that the interferometer measured."""

import numpy as np

from catseye.app.results.figures import Axis, Figure, Panel, Points, Role
from catseye.app.results.model import Bullets, Column, Paragraph, Section, Statement, Table, section
from catseye.app.results.numbers import PROBABILITY, counted, fixed
from catseye.app.results.said import before_and_after
from catseye.app.results.scara.distance_validation import DistanceValidation, ModelOnDistances
from catseye.app.results.scara.names import MODEL_TITLES
from catseye.app.results.scara.path_view import PathAxis, arrow_of, path_axis
from catseye.app.results.scara.validation_text import compared_text, ratio_statement
from catseye.calibration.core.types import Bools

_UM = fixed(1)


def distance_statement(distances: DistanceValidation) -> Statement:
    """Return what the last model leaves, and how much less than the first."""
    last, first = distances.models[-1], distances.models[0]
    after, before = (f"{MODEL_TITLES[one.model]} {one.rms_um:.1f} µm" for one in (last, first))
    return ratio_statement(
        f"On distances along a path the {MODEL_TITLES[last.model]} leaves {last.rms_um:.1f} µm rms",
        f"the {before}",
        distances.ratio,
        compared_text(distances.compared),
        before_and_after(before, after),
        last.probability,
    )


def distance_section(distances: DistanceValidation | None) -> Section:
    """Return figure and comparison of distances along the path."""
    key, title = "validation-distances", "Validation path, measured by distances"
    if distances is None:
        return section(key, title, ())
    return section(
        key,
        title,
        [
            Paragraph(_measured(distances)),
            _comparison(distances),
            Paragraph(
                "Ratio: rms over that of the first model. p: probability of deviations this large if the stated "
                "uncertainties are all there is."
            ),
            Bullets("", distances.rejected) if distances.rejected else None,
            distance_figure(distances),
        ],
    )


def _measured(distances: DistanceValidation) -> str:
    points, compared = distances.path.points, int(distances.compared.sum())
    return (
        f"Path {path_axis(distances.path).title}; {len(points)} distances to "
        f"{', '.join(points.reflector_names)} in {counted(len(points.dead_paths), 'segment')}. {compared} compared, "
        f"{len(points) - compared} left out (beyond the nodes, just reversed, or in a short segment); all models are "
        "compared over the same rows. Distances see the error along the beam only."
    )


def _comparison(distances: DistanceValidation) -> Table:
    first_um = distances.models[0].rms_um
    return Table(
        "distance_models",
        "Measured minus predicted distance",
        (
            Column("model", "model"),
            Column("rms_um", "rms", "µm", _UM),
            Column("max_um", "largest", "µm", _UM),
            Column("ratio", "ratio", format=fixed(2)),
            Column("median_u_um", "U of deviation", "µm", _UM, standard=True),
            Column("probability", "p", format=PROBABILITY),
        ),
        tuple(
            (
                MODEL_TITLES[model.model],
                model.rms_um,
                model.max_um,
                model.rms_um / first_um if first_um > 0.0 else None,
                model.median_u_um,
                model.probability,
            )
            for model in distances.models
        ),
    )


def distance_figure(distances: DistanceValidation) -> Figure:
    """Return a panel for each model."""
    axis, there = path_axis(distances.path), distances.path.travel > 0
    panels = tuple(
        _panel("abcdef"[place], model, axis, there) for place, model in enumerate(distances.models)
    )
    return Figure(
        "path-distances",
        "Deviations of distances along the validation path",
        "Measured minus predicted distance; error bars: U (k = 2). One dead "
        "path is fitted for each segment and model. Arrows: the direction of driving.",
        (panels,),
        aspect=0.43,
    )


def _panel(letter: str, model: ModelOnDistances, axis: PathAxis, there: Bools) -> Panel:
    known = np.isfinite(model.deviation_mm)
    ways = ((there, Role.POSITIVE, "o", "there"), (~there, Role.NEGATIVE, "s", "back"))
    marks = tuple(
        Points(
            axis.values_mm[rows & known],
            1e3 * model.deviation_mm[rows & known],
            ink,
            f"way {name} {arrow_of(axis.values_mm[rows])}",
            1e3 * model.u_mm[rows & known],
            marker=marker,
            size=4.0,
            hollow=True,
        )
        for rows, ink, marker, name in ways
    )
    first = letter == "a"
    upwards = Axis("measured − predicted / µm" if first else "", shared=not first)
    return Panel(f"{letter}) {MODEL_TITLES[model.model]}", Axis(axis.label), upwards, marks)
