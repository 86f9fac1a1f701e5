"""Commands of a measurement: what became of each, over the joints or from above, coloured by its innovation."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from catseye.app.results.figures import Axis, Figure, Ink, Mark, Panel, Points, Role, columns
from catseye.app.results.numbers import EXPANDED
from catseye.app.results.scara.commands_so_far import MeasurementSoFar, Part, Status
from catseye.app.results.scara.figures.layout import arm_marks, reach_marks, target_marks
from catseye.app.results.scara.layout import scene_of
from catseye.calibration.core.types import Bools, Floats
from catseye.calibration.scara.planar import forward

_ASIDE: Final = 0.25
"""A command stands beside its node by this share of the spacing, on the side that it is approached from."""

_EXPECTED, _OUTLYING = 1.0, 3.0
"""Innovations within so many of their standard uncertainties are as expected; beyond so many they are outlying."""


@dataclass(frozen=True)
class _Kind:
    """Commands that look alike.

    Attributes:
        label: in the legend.
        ink: of them.
        marker: by its name in matplotlib.
        hollow: not filled.
    """

    label: str
    ink: Ink
    marker: str
    hollow: bool = False


_WITHOUT: Final[tuple[tuple[Status, _Kind], ...]] = (
    ("planned", _Kind("planned", Role.MUTED, ".")),
    ("hidden", _Kind("hidden", Role.MUTED, "+")),
    ("left out", _Kind("left out", Role.CHOSEN, "x")),
    ("under way", _Kind("under way", Role.BEAM, "P")),
)
_UNPREDICTED: Final = _Kind("measured, not predicted", Role.COMMAND, "o", hollow=True)
_SCALE: Final = (
    (-np.inf, -_OUTLYING, _Kind("below −3 u: outlying", Role.CHOSEN, "v")),
    (-_OUTLYING, -_EXPECTED, _Kind("−3 … −1 u", Role.BELOW, "v", hollow=True)),
    (-_EXPECTED, _EXPECTED, _Kind("within ±1 u", Role.CONVENTIONAL, "o")),
    (_EXPECTED, _OUTLYING, _Kind("1 … 3 u", Role.ABOVE, "^", hollow=True)),
    (_OUTLYING, np.inf, _Kind("above 3 u: outlying", Role.CHOSEN, "^")),
)
"""Innovations in units of u, and how they look."""


def command_figure(so_far: MeasurementSoFar, parts: Sequence[Part]) -> Figure:
    """Return θ1 and θ2 of every command, a panel for each reflector."""
    theta, spacing = so_far.theta_deg, _spacing(so_far)
    beside = theta - _ASIDE * spacing * so_far.direction
    panels = tuple(
        Panel(
            f"{part.title}: {_count(part)}",
            Axis("θ1 / °"),
            Axis("θ2 / °") if not place else Axis(shared=True),
            tuple(_marks(part, beside)),
        )
        for place, part in enumerate(parts)
    )
    caption = (
        "Each command stands on the side of its node that it is approached from. Innovation: measured minus "
        f"predicted from all distances before, in its standard uncertainty u = U/2{_u_text(so_far)}."
    )
    return Figure("commands", "Commands and their innovations", caption, (panels,), aspect=0.5)


def top_view_figure(so_far: MeasurementSoFar, part: Part) -> Figure | None:
    """Return the bench from above with the commands of one reflector, and the arm at the newest of them."""
    scene = scene_of(so_far.bench, None, None)
    if scene is None:
        return None
    theta = np.deg2rad(so_far.theta_deg)
    place = forward(theta[:, 0], theta[:, 1], scene.link1_mm, scene.link2_mm)
    marks = reach_marks(scene)
    for number, target in enumerate(scene.targets):
        marks += target_marks(scene, replace(target, blind_mm=np.zeros((0, 2))), number)
    aim = next((one for one in scene.targets if one.name == part.reflector.name), None)
    newest = np.flatnonzero(~(part.are("planned") | part.are("hidden")))
    if newest.size:
        theta1, theta2 = np.deg2rad(so_far.theta_deg[newest[-1]]).tolist()
        marks += arm_marks(scene, (theta1, theta2), aim, "arm")
    panel = Panel(
        f"{part.title}: {_count(part)}",
        Axis("X / mm"),
        Axis("Y / mm"),
        (*marks, *_foremost(part, place)),
        equal=True,
    )
    caption = (
        "The bench from above with the arm at the newest command. Of commands that lead to one place, from "
        "several sides, the most telling is shown."
    )
    return Figure("top-view", "Commands from above", caption, ((panel,),), aspect=0.66, legend="right")


def _spacing(so_far: MeasurementSoFar) -> Floats:
    """Return the least distance of neighbouring nodes, shape (2,)."""
    nodes = so_far.bench.nodes1_deg, so_far.bench.nodes2_deg
    return np.array([np.diff(one).min() for one in nodes])


def _kinds(part: Part) -> list[tuple[Bools, _Kind]]:
    """Return the commands of each kind, those that say most last."""
    share, measured = part.share, part.are("measured")
    scale = sorted(_SCALE, key=lambda one: min(abs(one[0]), abs(one[1])))
    return [
        *((part.are(status), kind) for status, kind in _WITHOUT[:2]),
        (measured & np.isnan(share), _UNPREDICTED),
        *((measured & (share > low) & (share <= high), kind) for low, high, kind in scale),
        *((part.are(status), kind) for status, kind in _WITHOUT[2:]),
    ]


def _marks(part: Part, at: Floats) -> list[Mark]:
    """Return every command; at has the shape (n, 2)."""
    return [_points(kind, at[own]) for own, kind in _kinds(part) if own.any()]


def _foremost(part: Part, at: Floats) -> list[Mark]:
    """Return one command at each place."""
    kinds = _kinds(part)
    rank = np.max([np.where(own, number, -1) for number, (own, _) in enumerate(kinds)], axis=0)
    _, place = np.unique(np.round(at, 6), axis=0, return_inverse=True)
    top = np.full(place.max() + 1, -1)
    np.maximum.at(top, place, rank)
    first = np.unique(place, return_index=True)[1]
    marks = ((kind, first[top == number]) for number, (_, kind) in enumerate(kinds))
    return [_points(kind, at[own]) for kind, own in marks if own.size]


def _points(kind: _Kind, at: Floats) -> Points:
    return Points(
        *columns(at), kind.ink, kind.label, marker=kind.marker, hollow=kind.hollow, size=4.0, each=True
    )


def _count(part: Part) -> str:
    """Return how many of the commands that were to be measured were, and how many lie outside."""
    measured, outlying = part.are("measured"), _outlying(part)
    planned = int((~part.are("hidden")).sum())
    left_out = int(part.are("left out").sum())
    texts = [f"{int(measured.sum())} of {planned}"]
    texts += [f"{int(outlying.sum())} outlying"] if outlying.any() else []
    texts += [f"{left_out} left out"] if left_out else []
    return ", ".join(texts)


def _outlying(part: Part) -> Bools:
    with np.errstate(invalid="ignore"):
        return np.asarray(np.abs(part.share) > _OUTLYING)


def _u_text(so_far: MeasurementSoFar) -> str:
    return "" if so_far.u_um is None else f" (median U = {EXPANDED * so_far.u_um:.1f} µm, k = 2)"
