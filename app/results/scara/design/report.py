"""What a design says: where to put the reflectors, which commands to use, what it costs at the bench."""

import numpy as np

from catseye.app.results.model import (
    Bullets,
    Cell,
    Column,
    Paragraph,
    Report,
    Section,
    Sign,
    Statement,
    Table,
    section,
)
from catseye.app.results.numbers import (
    COUNT,
    DURATION,
    EXPANDED,
    PLAIN,
    counted,
    duration_text,
    fixed,
    number,
)
from catseye.app.results.origin import origin_now
from catseye.app.results.scara.design.bench_time import BenchCost
from catseye.app.results.scara.design.commands import CommandChoice
from catseye.app.results.scara.design.design import Design, NodeUncertainty, weakest
from catseye.app.results.scara.design.figures.front import front_figure
from catseye.app.results.scara.design.figures.places import places_figure
from catseye.app.results.scara.design.figures.weakness import node_figure, position_figure
from catseye.app.results.scara.design.layouts import Layout
from catseye.app.results.scara.design.reversal import Reversal
from catseye.app.results.scara.names import node_name
from catseye.calibration.core.design.criteria import CriterionName

CRITERIA: tuple[CriterionName, ...] = ("A", "D", "E", "path")

_VALUE, _UM, _MDEG = fixed(3), fixed(1), fixed(2)

_ARM = (
    Column("u_link1_um", "U(L1)", "µm", _UM, standard=True),
    Column("u_link2_um", "U(L2)", "µm", _UM, standard=True),
    Column("u_theta1_mdeg", "largest U(Δθ1)", "mdeg", _MDEG, standard=True),
    Column("u_theta2_mdeg", "largest U(Δθ2)", "mdeg", _MDEG, standard=True),
)


def design_report(design: Design, cell_name: str) -> Report:
    """Return what a design says."""
    sections = (
        _places(design),
        _comparison(design),
        _weakness(design),
        _reversal(design),
        _commands(design),
        _front(design),
    )
    return Report(f"Design of a measurement: {cell_name}", origin_now(), sections)


def _places(design: Design) -> Section:
    criterion, places = design.problem.criterion, design.places
    reasons = ", ".join(f"{count} {reason}" for reason, count in places.reasons.items())
    contents = (
        "everything that [uncertainty] states, also what does not average out"
        if design.problem.systematic
        else "only what averages out"
    )
    texts = [
        f"Criterion {criterion.name}: {criterion.meaning}, {criterion.unit}, k = 2; it contains {contents}.",
        f"Path: {design.problem.path_text}.",
        f"{counted(len(places.allowed), 'place')} allowed on a grid of {number(places.spacing_mm, COUNT)} mm, "
        f"{len(places.excluded)} excluded ({reasons or 'none'}); the best are then moved off the grid.",
    ]
    return section(
        "places",
        "Where to put the reflectors",
        [*(Statement(Sign.NEUTRAL, text) for text in texts), places_figure(design), _place_table(design)],
        brief=True,
    )


def _place_table(design: Design) -> Table:
    return Table(
        "places",
        "Places",
        (
            Column("name", "reflector"),
            Column("x_mm", "x", "mm", PLAIN),
            Column("y_mm", "y", "mm", PLAIN),
            Column("facing_deg", "facing", "°", fixed(1)),
            Column("commands_seen", "commands seen", format=COUNT),
            Column("commands", "of", format=COUNT),
            Column("breaks", "breaks of the beam", format=COUNT),
        ),
        tuple(
            (
                f"P{place}",
                *sight.xy_mm.tolist(),
                float(np.rad2deg(sight.facing_rad)),
                int(sight.seen.sum()),
                sight.seen.size,
                sight.breaks,
            )
            for place, sight in enumerate(design.layout.sights, 1)
        ),
    )


def _comparison(design: Design) -> Section:
    meanings = tuple(
        f"{name}: {design.problem.with_criterion(name).meaning}, {design.problem.with_criterion(name).unit}"
        for name in CRITERIA
    )
    return section(
        "comparison",
        "Comparison",
        [
            _uncertainties(design),
            Bullets("", meanings),
            Paragraph("Links count as the angles that they look like at full reach."),
            _costs(design),
            _plan_statement(design.layouts[0].cost),
        ],
        brief=True,
    )


def _uncertainties(design: Design) -> Table:
    rows = [
        _uncertain(layout, systematic=systematic) for layout in design.layouts for systematic in (False, True)
    ]
    if design.choice is not None:
        rows += [_chosen(design, design.choice, systematic=systematic) for systematic in (False, True)]
    return Table(
        "uncertainties",
        "Expanded uncertainties U (k = 2)",
        (
            Column("layout", "layout"),
            Column("errors", "errors"),
            *(
                Column(name, name, "µm" if name == "path" else "mdeg", _VALUE, standard=True)
                for name in CRITERIA
            ),
            *_ARM,
        ),
        tuple(rows),
    )


def _uncertain(layout: Layout, *, systematic: bool) -> tuple[Cell, ...]:
    return (
        layout.name,
        _errors(systematic=systematic),
        *(layout.shown(name, systematic=systematic) for name in CRITERIA),
        *layout.u_of_arm(systematic=systematic),
    )


def _chosen(design: Design, choice: CommandChoice, *, systematic: bool) -> tuple[Cell, ...]:
    values = (choice.shown(name, systematic=systematic) for name in CRITERIA)
    return (_choice_name(design, choice), _errors(systematic=systematic), *values, *[None] * 4)


def _errors(*, systematic: bool) -> str:
    return "all" if systematic else "random"


def _choice_name(design: Design, choice: CommandChoice) -> str:
    return f"{design.layout.name}, {int(choice.kept.sum())} commands"


def _costs(design: Design) -> Table:
    costs = [(layout.name, layout.cost) for layout in design.layouts]
    if design.choice is not None:
        costs.append((_choice_name(design, design.choice), design.choice.cost))
    return Table(
        "costs",
        "At the bench, as the plan of open-loop says; times are estimates without search and set-up",
        (
            Column("layout", "layout"),
            Column("points", "distances", format=COUNT),
            Column("blind", "blind commands", format=COUNT),
            Column("planned_breaks", "planned breaks", format=COUNT),
            Column("bench_s", "bench time", format=DURATION),
            Column("refused", "refused by the plan"),
        ),
        tuple(
            (name, cost.points, cost.blind, cost.breaks, cost.duration_s, cost.refused)
            for name, cost in costs
        ),
    )


def _plan_statement(cost: BenchCost) -> Statement:
    """Return what the plan of the measurement says of a layout; bench times are estimates of that plan."""
    if cost.refused:
        return Statement(Sign.ATTENTION, f"The plan of open-loop refuses this layout: {cost.refused}.")
    return Statement(
        Sign.NEUTRAL,
        f"Planned: {cost.points} distances in about {duration_text(cost.duration_s)} (estimate of the plan, without "
        f"search and set-up), {cost.breaks} planned breaks of the beam, {cost.blind} blind commands.",
    )


def _weakness(design: Design) -> Section:
    worst = ", ".join(map(_weak_text, weakest(design.layout)))
    return section(
        "weakness",
        "Where the map is weak",
        [
            Statement(Sign.NEUTRAL, f"Most uncertain (k = 2): {worst}."),
            node_figure(design),
            position_figure(design),
        ],
        brief=True,
    )


def _weak_text(node: NodeUncertainty) -> str:
    return f"{node_name(node.joint, node.node_deg, node.direction)} U = {EXPANDED * node.u_mdeg:.2f} mdeg"


def _reversal(design: Design) -> Section:
    """Return what it is worth to measure a second time with the interferometer turned on J4."""
    title = "What turning the interferometer on J4 is worth"
    if not design.reversals:
        return section("reversal", title, ())
    table = Table(
        "reversal",
        "Expanded uncertainties U (k = 2) from all errors, the whole plan measured once or twice",
        (Column("layout", "layout"), Column("measured", "measured"), *_ARM),
        tuple(
            (one.once.name, way, *layout.u_of_arm(systematic=True))
            for one in design.reversals
            for way, layout in one.ways
        ),
    )
    texts = [Statement(Sign.NEUTRAL, _worth_text(one)) for one in design.reversals]
    return section("reversal", title, [*texts, table], brief=True)


def _worth_text(reversal: Reversal) -> str:
    """Return what the turn brings beyond a second measurement without it."""
    again, turned = (np.array(one.u_of_arm(systematic=True)) for one in (reversal.again, reversal.turned))
    with np.errstate(invalid="ignore"):
        shares = np.where(np.isfinite(turned), turned / again, 1.0)
    names = ("U(L1)", "U(L2)", "largest U(Δθ1)", "largest U(Δθ2)")
    parts = ", ".join(
        f"{name} × {number(float(share), fixed(2))}" for name, share in zip(names, shares, strict=True)
    )
    return (
        f"{reversal.once.name}: a second measurement with the interferometer turned by half a turn on J4, against "
        f"one without the turn: {parts}."
    )


def _commands(design: Design) -> Section:
    choice = design.choice
    if choice is None:
        return section("commands", "Which commands", ())
    problem = design.problem
    criterion = problem.criterion
    whole, chosen = (
        number(EXPANDED * one.shown(criterion.name, systematic=problem.systematic), _VALUE)
        for one in (design.layout, choice)
    )
    texts = [
        f"{int(choice.kept.sum())} of {choice.kept.size} commands: criterion {criterion.name} {chosen} "
        f"{criterion.unit} instead of {whole} {criterion.unit} (k = 2), bench time "
        f"{duration_text(choice.cost.duration_s)} instead of {duration_text(design.layout.cost.duration_s)}.",
        "Open-loop measures whole grids of nodes; a choice of commands is for programs of your own, or a hint which "
        "nodes may be left out.",
    ]
    too_few = _too_few(choice)
    statements = [Statement(Sign.NEUTRAL, text) for text in texts]
    return section(
        "commands",
        "Which commands",
        [
            *statements,
            Statement(Sign.ATTENTION, too_few) if too_few else None,
            _command_table(design, choice),
        ],
        brief=True,
    )


def _too_few(choice: CommandChoice) -> str:
    kept = int(choice.kept.sum())
    if choice.asked is None or kept <= choice.asked:
        return ""
    return f"{choice.asked} commands leave parameters undetermined; the fewest that do not are {kept}."


def _command_table(design: Design, choice: CommandChoice) -> Table:
    signs = (("+ +", 1, 1), ("+ −", 1, -1), ("− +", -1, 1), ("− −", -1, -1))
    return Table(
        "commands",
        "Commands chosen",
        (
            Column("theta1_deg", "θ1", "°"),
            *(Column(f"theta2_deg {name}", f"θ2 / °, directions {name}") for name, _, _ in signs),
        ),
        tuple(
            (number(node, PLAIN), *(_kept(design, choice, node, one, two) for _, one, two in signs))
            for node in design.problem.bench.nodes1_deg
        ),
    )


def _kept(design: Design, choice: CommandChoice, theta1_deg: float, direction1: int, direction2: int) -> str:
    return ", ".join(
        f"{command.theta2_deg:g}"
        for command, keep in zip(design.problem.sequence, choice.kept, strict=True)
        if keep
        and (command.theta1_deg, command.direction1, command.direction2)
        == (theta1_deg, direction1, direction2)
    )


def _front(design: Design) -> Section:
    title = "Bench time against uncertainty"
    if not design.compromises:
        return section("front", title, ())
    unit = design.problem.criterion.unit
    table = Table(
        "front",
        "Compromises nothing beats; U of the criterion (k = 2)",
        (
            Column("reflectors", "reflectors", format=COUNT),
            Column("commands", "commands", format=COUNT),
            Column("repeats", "repeats", format=COUNT),
            Column("bench_s", "bench time", format=DURATION),
            Column("u_random", "U, random", unit, _VALUE, standard=True),
            Column("u", "U, all", unit, _VALUE, standard=True),
        ),
        tuple(
            (row.reflectors, row.commands, row.repeats, row.time_s, row.u_white, row.u_total)
            for row in design.compromises
            if row.front
        ),
    )
    beaten = sum(not row.front for row in design.compromises)
    text = f"{beaten} further compromises are beaten in time and uncertainty; --json lists them too."
    return section("front", title, [front_figure(design), table, Statement(Sign.NEUTRAL, text)], brief=True)
