"""Error maps of both joints with their reversal error (Fig. 6 of the SCARA paper)."""

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from catseye.app.files.result_json import MapTable, Result
from catseye.app.render.canvas import NEGATIVE, POSITIVE, STYLE, TRUTH, WIDTH_IN
from catseye.app.results.scara.content import TruthMap, TruthTables
from catseye.app.results.scara.reversal import reversal_mdeg, u_reversal_mdeg


@rc_context(STYLE)
def error_map_figure(result: Result, truth: TruthTables | None = None) -> Figure:
    """Draw the maps at their nodes with error bars (k = 1), the truth as thin lines when it is known.

    Args:
        result: an error map.
        truth: in the same gauge.
    """
    figure = Figure(figsize=(WIDTH_IN, 5.2))
    axes = figure.subplots(2, 2, sharex="col", height_ratios=(3, 1.3))
    for column, joint in enumerate((1, 2)):
        table = result.theta1_map if joint == 1 else result.theta2_map
        if table is None:
            continue
        true_map = None if truth is None else (truth.theta1_map if joint == 1 else truth.theta2_map)
        _map(axes[0, column], table, true_map, joint)
        _reversal(axes[1, column], table, true_map, u_reversal_mdeg(result, joint), joint)
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=4)
    return figure


def _map(axes: Axes, table: MapTable, truth: TruthMap | None, joint: int) -> None:
    axes.axhline(0.0, color="#5f6670", linewidth=0.6)
    if truth is not None:
        for values, dash, name in (
            (truth.positive_mdeg, "-", "truth, positive"),
            (truth.negative_mdeg, "--", "truth, negative"),
        ):
            axes.plot(truth.node_deg, values, color=TRUTH, linewidth=0.7, linestyle=dash, label=name)
    for values, u, colour, marker, name in (
        (table.positive_mdeg, table.u_positive_mdeg, POSITIVE, "^", "positive direction (+1)"),
        (table.negative_mdeg, table.u_negative_mdeg, NEGATIVE, "v", "negative direction (−1)"),
    ):
        axes.errorbar(
            table.node_deg, values, u, color=colour, marker=marker, markersize=4.5, capsize=3.0, label=name
        )
    axes.set_title(f"{'ab'[joint - 1]}) J{joint}")
    axes.set_ylabel(f"Δθ{joint} / mdeg")


def _reversal(
    axes: Axes, table: MapTable, truth: TruthMap | None, u_mdeg: list[float] | None, joint: int
) -> None:
    if truth is not None:
        difference = np.subtract(truth.negative_mdeg, truth.positive_mdeg)
        axes.plot(truth.node_deg, difference, color=TRUTH, linewidth=0.7)
    axes.errorbar(
        table.node_deg, reversal_mdeg(table), u_mdeg, color="#5b3a8c", marker="o", markersize=3.5, capsize=3.0
    )
    axes.set_xlabel(f"command θ{joint} / °")
    axes.set_ylabel("reversal / mdeg")
