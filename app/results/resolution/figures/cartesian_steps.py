"""Least increment steps of the tool by direction, predicted and measured (Fig. 11 of the resolution paper)."""

from collections.abc import Sequence
from typing import Final

from catseye.app.results.figures import Axis, Figure, Mark, Panel, Role
from catseye.app.results.resolution.cartesian_comparison import Compared, direction_word
from catseye.app.results.resolution.figures.least_steps import PointWithEnds, decades_of, with_intervals
from catseye.app.results.resolution.figures.panels import aspect_of, in_rows

_BESIDE: Final = 0.12
"""Predicted points stand so far to the left of their direction, measured ones to the right."""
_NAMES: Final = ("+X", "−X", "+Y", "−Y", "+Z", "−Z")
_CAPTION: Final = (
    "Least increment steps of the tool with their 95 % intervals, one panel per pose. The interval of a prediction "
    "contains what a single measurement finds in 95 % of cases. A direction without a point has no least step, or "
    "only an upper limit; the tables say why."
)


def cartesian_step_figure(compared: Sequence[Compared]) -> Figure | None:
    """Return least steps by direction, a panel a pose; None where there are none."""
    poses = list(dict.fromkeys(one.test.pose or "" for one in compared))
    scale = decades_of("least step / mm", [end for one in compared for end in _ends(one)])
    panels = [
        Panel(pose, Axis("direction", low=-0.5, high=5.5, names=_NAMES), scale, tuple(marks))
        for pose in poses
        if (marks := _marks([one for one in compared if (one.test.pose or "") == pose]))
    ]
    if not panels:
        return None
    rows = in_rows(panels)
    return Figure(
        "cartesian-steps",
        "Least increment steps of the tool",
        _CAPTION,
        rows,
        aspect=aspect_of(rows),
    )


def _ends(one: Compared) -> list[float]:
    """Return everything that is shown of a direction."""
    least = one.predicted
    predicted = () if least is None or least.lis is None else (least.lis, least.low, least.high)
    measured = () if one.test.lis is None else (one.test.lis.value, one.test.lis.low, one.test.lis.high)
    return [end for end in (*predicted, *measured) if end]


def _marks(compared: Sequence[Compared]) -> list[Mark]:
    predicted: list[PointWithEnds] = []
    measured: list[PointWithEnds] = []
    for one in compared:
        at = _NAMES.index(direction_word(one.test).replace("-", "−"))
        least = one.predicted
        if least is not None and least.lis is not None:
            # An end that is 0 or not known is drawn at the step itself.
            predicted.append((at - _BESIDE, least.lis, least.low or least.lis, least.high or least.lis))
        if one.test.lis is not None:
            measured.append((at + _BESIDE, one.test.lis.value, one.test.lis.low, one.test.lis.high))
    return [
        *with_intervals(predicted, Role.QUANTILE, "predicted", marker="s"),
        *with_intervals(measured, Role.CONVENTIONAL, "measured", marker="o"),
    ]
