"""Section about a validation path that the interferometer measured."""

import numpy as np

from catseye.app.render.drawing import figure
from catseye.app.render.markup import Html, bullets, paragraphs, section, table
from catseye.app.results.numbers import counted, fixd, plain
from catseye.app.results.scara.content import MODEL_TITLES, ReportContent
from catseye.app.results.scara.distance_validation import DistanceValidation
from catseye.app.results.scara.figures.distances import distance_figure


def distance_section(content: ReportContent) -> Html:
    """Return figure and comparison of distances along the path."""
    distances = content.distances
    if distances is None:
        return Html()
    drawn = figure(
        distance_figure(distances),
        "path-distances",
        "Deviations of distances along the validation path",
        "Predicted minus measured distance; error bars: standard uncertainty of the prediction (k = 1). One dead "
        "path is fitted for each segment and model.",
    )
    return section(
        "validation-distances",
        "Validation path, measured by distances",
        paragraphs(_measured(distances)),
        _comparison(distances),
        bullets(distances.rejected) if distances.rejected else "",
        drawn,
    )


def _measured(distances: DistanceValidation) -> str:
    points, compared = distances.path.points, int(distances.compared.sum())
    x, y = distances.path.command_mm.T
    return (
        f"Path X = {plain(np.mean(x))} mm, Y = {plain(y.min())} … {plain(y.max())} mm; {len(points)} distances to "
        f"{', '.join(points.reflector_names)} in {counted(len(points.dead_paths), 'segment')}. {compared} compared, "
        f"{len(points) - compared} left out (beyond the nodes, just reversed, or in a short segment); all models are "
        "compared over the same rows. Distances see the error along the beam only."
    )


def _comparison(distances: DistanceValidation) -> Html:
    reference = distances.models[0].rms_um
    rows = [
        [
            MODEL_TITLES[model.model],
            fixd(model.rms_um, 1),
            fixd(model.max_um, 1),
            fixd(model.rms_um / reference, 2) if reference > 0.0 else fixd(None, 2),
            fixd(model.median_u_um, 1),
        ]
        for model in distances.models
    ]
    head = ["model", "rms / µm", "largest / µm", "ratio", "u of prediction / µm"]
    inner = table("Predicted minus measured distance", head, rows)
    return Html(inner + paragraphs("Ratio: rms over that of the first model."))
