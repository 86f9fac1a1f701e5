"""Bench time against uncertainty."""

from matplotlib import rc_context
from matplotlib.figure import Figure

from catseye.app.render.canvas import STYLE, WIDTH_IN, series
from catseye.app.results.numbers import counted
from catseye.app.results.scara.design.design import Design


@rc_context(STYLE)
def front_figure(found: Design) -> Figure:
    """Draw every compromise; those that nothing beats are joined."""
    figure = Figure(figsize=(WIDTH_IN, 4.0))
    axes = figure.subplots()
    rows = [row for row in found.compromises if row.time_s == row.time_s and row.u_total < float("inf")]
    front = [row for row in rows if row.front]
    axes.step(
        [row.time_s / 60.0 for row in front],
        [row.u(systematic=found.problem.systematic) for row in front],
        where="post",
        color="#5f6670",
        linewidth=1.0,
        label="nothing beats these",
    )
    for count in sorted({row.reflectors for row in rows}):
        colour, marker = series(count - 1)
        own = [row for row in rows if row.reflectors == count]
        axes.plot(
            [row.time_s / 60.0 for row in own],
            [row.u_total for row in own],
            marker,
            color=colour,
            markersize=5.0,
            label=counted(count, "reflector"),
        )
        axes.plot(
            [row.time_s / 60.0 for row in own],
            [row.u_white for row in own],
            marker,
            color=colour,
            markersize=4.0,
            markerfacecolor="none",
            alpha=0.6,
        )
    axes.set_xlabel("bench time / min (estimate of the plan)")
    axes.set_ylabel(f"criterion {found.problem.criterion.name} / {found.problem.criterion.unit}")
    axes.set_ylim(bottom=0.0)
    axes.legend(loc="upper right", ncols=2)
    return figure
