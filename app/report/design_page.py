"""One self-contained page about a design."""

from pathlib import Path

import numpy as np

from catseye.app.analysis.design_layouts import Layout
from catseye.app.analysis.designing import Design, weakest
from catseye.app.report.drawing import figure
from catseye.app.report.figures.design_front import front_figure
from catseye.app.report.figures.design_places import places_figure
from catseye.app.report.figures.design_weakness import node_figure, position_figure
from catseye.app.report.markup import Html, bullets, element, paragraphs, section, table
from catseye.app.report.numbers import counted, duration, fixed, plain
from catseye.app.store.software import SOFTWARE
from catseye.calibration.core.design.criteria import CriterionName

_STYLE = Path(__file__).with_name("report.css")
_CRITERIA: tuple[CriterionName, ...] = ("A", "D", "E", "path")


def render_design(found: Design, cell_name: str) -> str:
    """Return the page: style and figures inside, no script, nothing loaded."""
    title = f"Design of a measurement: {cell_name}"
    head = element(
        "head",
        Html('<meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">'),
        element("title", title),
        element("style", Html(_STYLE.read_text(encoding="utf-8"))),
    )
    header = element("header", element("h1", title), element("p", SOFTWARE, class_="made"))
    parts = (_places(found), _comparison(found), _weakness(found), _commands(found), _front(found))
    page = element("html", head, element("body", header, element("main", *parts)), lang="en")
    return f"<!DOCTYPE html>\n{page}\n"


def _places(found: Design) -> Html:
    rows = [
        [
            f"P{k}",
            fixed(float(sight.xy_mm[0]), 0),
            fixed(float(sight.xy_mm[1]), 0),
            fixed(float(np.rad2deg(sight.facing_rad)), 1),
            f"{int(sight.seen.sum())} of {sight.seen.size}",
            str(sight.breaks),
        ]
        for k, sight in enumerate(found.layout.sights, 1)
    ]
    head = ["reflector", "x / mm", "y / mm", "facing / °", "commands seen", "breaks of the beam"]
    criterion, places = found.problem.criterion, found.places
    text = (
        f"Criterion {criterion.name}: {criterion.meaning}. {_contents(found)} "
        f"{counted(len(places.allowed), 'place')} allowed on a grid of {fixed(places.spacing_mm, 0)} mm, "
        f"{len(places.excluded)} excluded; the best are then moved off the grid."
    )
    caption = (
        "Candidates coloured by the criterion if the reflector that is missed least stood there instead; darker is "
        "better. Grey marks: no reflector may stand there, by reason. Wedges: fields of the chosen reflectors."
    )
    drawn = figure(places_figure(found), "places", "Places for reflectors seen from above", caption)
    return section(
        "places", "Where to put the reflectors", paragraphs(text), drawn, table("Places", head, rows)
    )


def _contents(found: Design) -> str:
    if found.problem.systematic:
        return "It contains everything that [uncertainty] states, also what does not average out."
    return "It contains only what averages out."


def _comparison(found: Design) -> Html:
    rows = [row for layout in found.layouts for row in _rows(found, layout)]
    head = ["layout", "errors", "A / mdeg", "D / mdeg", "E / mdeg", "path / µm"]
    head += ["u(L1) / µm", "u(L2) / µm", "largest u(Δθ1) / mdeg", "largest u(Δθ2) / mdeg"]
    costs = [
        [
            layout.name,
            str(layout.cost.points),
            str(layout.cost.blind),
            str(layout.cost.breaks),
            layout.cost.refused or duration(layout.cost.duration_s),
        ]
        for layout in found.layouts
    ]
    meaning = bullets(
        f"{name}: {found.problem.with_criterion(name).meaning}, {found.problem.with_criterion(name).unit}"
        for name in _CRITERIA
    )
    path = f"Path: {found.problem.path_text}. Links count as the angles that they look like at full reach."
    return section(
        "comparison",
        "Comparison",
        table("Standard uncertainties (k = 1)", head, rows, text_columns=2),
        meaning,
        paragraphs(path),
        table(
            "At the bench, as the plan of open-loop says; times are estimates without search and set-up",
            ["layout", "distances", "blind commands", "planned breaks", "bench time"],
            costs,
        ),
    )


def _rows(found: Design, layout: Layout) -> list[list[str]]:
    arm = found.problem.study.layout
    rows = []
    for systematic, name in ((False, "random"), (True, "all")):
        u = layout.u(systematic=systematic)
        maps = (1e3 * np.rad2deg(u[part].max()) for part in (arm.map1, arm.map2))
        rows.append(
            [
                layout.name,
                name,
                *(fixed(layout.shown(one, systematic=systematic), 3) for one in _CRITERIA),
                fixed(1e3 * float(u[0]), 1),
                fixed(1e3 * float(u[1]), 1),
                *(fixed(float(value), 2) for value in maps),
            ]
        )
    return rows


def _weakness(found: Design) -> Html:
    worst = [
        f"Δθ{one.joint} at {plain(one.node_deg)}°, {'positive' if one.direction > 0 else 'negative'} direction: "
        f"{fixed(one.u_mdeg, 2)} mdeg"
        for one in weakest(found.layout)
    ]
    nodes = figure(
        node_figure(found),
        "nodes",
        "Uncertainty of the nodes of both maps",
        "Standard uncertainty of each value of the maps (k = 1), in the gauge that the J1 map has zero mean.",
    )
    positions = figure(
        position_figure(found),
        "positions",
        "Uncertainty of predicted positions over the workspace",
        "Standard uncertainty of predicted positions in the worst direction, for the worst directions of approach. "
        "Ellipses: k = 1 at the nodes approached upwards, magnified alike in both pictures.",
    )
    return section(
        "weakness", "Where the map is weak", paragraphs("Most uncertain:"), bullets(worst), nodes, positions
    )


def _commands(found: Design) -> Html:
    choice = found.choice
    if choice is None:
        return Html()
    problem = found.problem
    name = problem.criterion.name
    whole = found.layout.shown(name, systematic=problem.systematic)
    chosen = choice.shown(name, systematic=problem.systematic)
    text = (
        f"{int(choice.kept.sum())} of {choice.kept.size} commands: criterion {name} {fixed(chosen, 3)} "
        f"{problem.criterion.unit} instead of {fixed(whole, 3)} {problem.criterion.unit}, bench time "
        f"{duration(choice.cost.duration_s)} instead of {duration(found.layout.cost.duration_s)}."
    )
    bench = problem.bench
    signs = (("+ +", 1, 1), ("+ −", 1, -1), ("− +", -1, 1), ("− −", -1, -1))
    rows = [
        [plain(node), *(_kept(found, node, one, two) for _, one, two in signs)] for node in bench.nodes1_deg
    ]
    head = ["θ1 / °", *(f"θ2 / °, directions {name}" for name, _, _ in signs)]
    return section("commands", "Which commands", paragraphs(text), table("Commands chosen", head, rows, 5))


def _kept(found: Design, theta1_deg: float, direction1: int, direction2: int) -> str:
    choice = found.choice
    if choice is None:
        return ""
    return ", ".join(
        f"{one.theta2_deg:g}"
        for one, keep in zip(found.problem.sequence, choice.kept, strict=True)
        if keep and (one.theta1_deg, one.direction1, one.direction2) == (theta1_deg, direction1, direction2)
    )


def _front(found: Design) -> Html:
    if not found.compromises:
        return Html()
    unit = found.problem.criterion.unit
    rows = [
        [
            str(row.reflectors),
            str(row.commands),
            str(row.repeats),
            duration(row.time_s),
            fixed(row.u_white, 3),
            fixed(row.u_total, 3),
        ]
        for row in found.compromises
        if row.front
    ]
    head = ["reflectors", "commands", "repeats", "bench time", f"random / {unit}", f"all / {unit}"]
    caption = (
        "Filled: everything stated in the budget; open: only what averages out. More points lower the open marks, "
        "what does not average out keeps the filled ones up."
    )
    drawn = figure(front_figure(found), "front", "Bench time against uncertainty", caption)
    return section(
        "front", "Bench time against uncertainty", drawn, table("Compromises nothing beats", head, rows)
    )
