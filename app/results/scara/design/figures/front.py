"""Bench time against uncertainty."""

import numpy as np

from catseye.app.results.figures import Axis, Figure, Line, Mark, Panel, Points, Role
from catseye.app.results.numbers import EXPANDED, counted
from catseye.app.results.scara.design.design import Design


def front_figure(design: Design) -> Figure:
    """Return every compromise; those that nothing beats are joined."""
    rows = [row for row in design.compromises if row.time_s == row.time_s and row.u_total < float("inf")]
    front = [row for row in rows if row.front]
    marks: list[Mark] = [
        Line(
            np.array([row.time_s / 60.0 for row in front]),
            EXPANDED * np.array([row.u(systematic=design.problem.systematic) for row in front]),
            Role.AXIS,
            "nothing beats these",
            width=1.0,
            step=True,
        )
    ]
    for count in sorted({row.reflectors for row in rows}):
        own = [row for row in rows if row.reflectors == count]
        minutes = np.array([row.time_s / 60.0 for row in own])
        every, white = (
            EXPANDED * np.array(values)
            for values in ([row.u_total for row in own], [row.u_white for row in own])
        )
        marks += [
            Points(minutes, every, count - 1, counted(count, "reflector"), size=5.0),
            Points(minutes, white, count - 1, size=4.0, hollow=True, faint=True),
        ]
    criterion = design.problem.criterion
    upwards = Axis(f"U, criterion {criterion.name} / {criterion.unit}", low=0.0)
    return Figure(
        "front",
        "Bench time against uncertainty",
        "U: k = 2. Filled: everything stated in the budget; open: only what averages out. More points lower the open "
        "marks, what does not average out keeps the filled ones up.",
        ((Panel("", Axis("bench time / min (estimate of the plan)"), upwards, tuple(marks)),),),
        aspect=0.5,
        legend="inside",
        legend_columns=2,
    )
