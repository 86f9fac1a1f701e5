"""A design as JSON."""

import math

import numpy as np
from pydantic import Field

from catseye.app.protocol.message import absent
from catseye.app.results.document import Document, Stated
from catseye.app.results.scara.design.commands import CommandChoice
from catseye.app.results.scara.design.design import Design, node_uncertainties
from catseye.app.results.scara.design.layouts import Layout
from catseye.app.results.scara.design.report import CRITERIA
from catseye.app.results.scara.design.reversal import Reversal


class DesignedReflector(Document):
    """A reflector of the design.

    Attributes:
        facing_deg: where it looks.
        commands_seen: of the sequence, at which it returns the beam.
        breaks: times that the beam is given up on the way.
    """

    name: str
    x_mm: float
    y_mm: float
    facing_deg: float
    commands_seen: int
    breaks: int


class DesignedLayout(Document):
    """A layout with each criterion as an uncertainty; null where it is not determined.

    Attributes:
        places_mm: of its reflectors.
        bench_s: to measure it; null where the plan refuses it.
        points: distances.
        planned_breaks: times that the beam is given up, summed over the reflectors.
        blind: commands that cannot be measured, summed over the reflectors.
        refused: why the plan refuses it; empty as a rule.
    """

    name: str
    places_mm: list[tuple[float, float]]
    A_mdeg: Stated
    A_random_mdeg: Stated
    D_mdeg: Stated
    D_random_mdeg: Stated
    E_mdeg: Stated
    E_random_mdeg: Stated
    path_um: Stated
    path_random_um: Stated
    bench_s: Stated
    points: int
    planned_breaks: int
    blind: int
    refused: str


class DesignedNode(Document):
    """Standard uncertainty of one value of a map.

    Attributes:
        u_random_mdeg: by what averages out alone.
    """

    joint: int
    node_deg: float
    direction: int
    u_random_mdeg: Stated
    u_mdeg: Stated


class DesignedPlaces(Document):
    """Places that a reflector may take.

    Attributes:
        excluded: how many cannot be taken, by reason.
    """

    allowed: int
    excluded: dict[str, int]


class DesignedCompromise(Document):
    """One way to spend bench time.

    Attributes:
        front: nothing else is both faster and more certain.
    """

    reflectors: int
    commands: int
    repeats: int
    bench_s: Stated
    u_random: Stated
    u: Stated
    front: bool


class DesignedArm(Document):
    """Standard uncertainties of links and maps, the largest of each map."""

    u_link1_um: Stated
    u_link2_um: Stated
    u_theta1_mdeg: Stated
    u_theta2_mdeg: Stated


class DesignedReversal(Document):
    """A layout measured once, twice, and twice with the interferometer turned between."""

    name: str
    once: DesignedArm
    twice: DesignedArm
    turned: DesignedArm


class DesignDocument(Document):
    """A design; what is not a number is null.

    Attributes:
        criterion: that was minimised.
        unit: of its value.
        systematic: it counts what does not average out, too.
        path: of the criterion.
        pareto: compromises of bench time and uncertainty.
        j4_reversal: what it is worth to turn the interferometer.
        commands: chosen, in measuring order: angles in deg and directions; absent where none were chosen.
        commands_bench_s: to measure them.
        commands_value: the criterion as an uncertainty.
    """

    criterion: str
    unit: str
    systematic: bool
    path: str
    reflectors: list[DesignedReflector]
    layouts: list[DesignedLayout]
    nodes: list[DesignedNode]
    places: DesignedPlaces
    pareto: list[DesignedCompromise]
    j4_reversal: list[DesignedReversal]
    commands: list[tuple[float, float, int, int]] | None = Field(default=None, exclude_if=absent)
    commands_bench_s: Stated = Field(default=None, exclude_if=absent)
    commands_value: Stated = Field(default=None, exclude_if=absent)


def design_document(design: Design) -> DesignDocument:
    """Return a design as JSON has it."""
    problem, places = design.problem, design.places
    found = DesignDocument(
        criterion=problem.criterion.name,
        unit=problem.criterion.unit,
        systematic=problem.systematic,
        path=problem.path_text,
        reflectors=_reflectors(design),
        layouts=[_layout(layout) for layout in design.layouts],
        nodes=_nodes(design),
        places=DesignedPlaces(
            allowed=len(places.allowed),
            excluded={str(reason): count for reason, count in places.reasons.items()},
        ),
        pareto=_pareto(design),
        j4_reversal=[_reversal(one) for one in design.reversals],
    )
    return found if design.choice is None else found.model_copy(update=_chosen(design, design.choice))


def _chosen(design: Design, choice: CommandChoice) -> dict[str, object]:
    """Return the chosen commands in measuring order."""
    problem = design.problem
    commands = (problem.sequence[k] for k in np.flatnonzero(choice.kept))
    value = choice.shown(problem.criterion.name, systematic=problem.systematic)
    return {
        "commands": [
            (command.theta1_deg, command.theta2_deg, command.direction1, command.direction2)
            for command in commands
        ],
        "commands_bench_s": _finite(choice.cost.duration_s),
        "commands_value": _finite(value),
    }


def _reflectors(design: Design) -> list[DesignedReflector]:
    return [
        DesignedReflector(
            name=f"P{k}",
            x_mm=float(sight.xy_mm[0]),
            y_mm=float(sight.xy_mm[1]),
            facing_deg=round(float(np.rad2deg(sight.facing_rad)), 1),
            commands_seen=int(sight.seen.sum()),
            breaks=sight.breaks,
        )
        for k, sight in enumerate(design.layout.sights, 1)
    ]


def _nodes(design: Design) -> list[DesignedNode]:
    return [
        DesignedNode(
            joint=node.joint,
            node_deg=node.node_deg,
            direction=node.direction,
            u_random_mdeg=node.white_mdeg,
            u_mdeg=node.total_mdeg,
        )
        for node in node_uncertainties(design.layout)
    ]


def _pareto(design: Design) -> list[DesignedCompromise]:
    return [
        DesignedCompromise(
            reflectors=row.reflectors,
            commands=row.commands,
            repeats=row.repeats,
            bench_s=row.time_s,
            u_random=row.u_white,
            u=row.u_total,
            front=row.front,
        )
        for row in design.compromises
    ]


def _reversal(reversal: Reversal) -> DesignedReversal:
    """Return what a layout gives measured once, twice, and twice with the interferometer turned between."""
    return DesignedReversal(
        name=reversal.once.name,
        once=_arm(reversal.once),
        twice=_arm(reversal.again),
        turned=_arm(reversal.turned),
    )


def _arm(layout: Layout) -> DesignedArm:
    values = zip(DesignedArm.model_fields, layout.u_of_arm(systematic=True), strict=True)
    return DesignedArm.model_validate(dict(values))


def _layout(layout: Layout) -> DesignedLayout:
    values: dict[str, object] = {}
    for name in CRITERIA:
        unit = "um" if name == "path" else "mdeg"
        values[f"{name}_{unit}"] = layout.shown(name, systematic=True)
        values[f"{name}_random_{unit}"] = layout.shown(name, systematic=False)
    return DesignedLayout.model_validate(
        {
            "name": layout.name,
            "places_mm": [(float(x), float(y)) for x, y in layout.places_mm],
            **values,
            "bench_s": layout.cost.duration_s,
            "points": layout.cost.points,
            "planned_breaks": layout.cost.breaks,
            "blind": layout.cost.blind,
            "refused": layout.cost.refused,
        }
    )


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
