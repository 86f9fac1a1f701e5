"""Rows of a path that a model says nothing about, in words."""

from collections.abc import Sequence

import numpy as np

from catseye.app.results.scara.path_csv import SegmentNumbers
from catseye.calibration.core.types import Bools
from catseye.calibration.scara.identification import IdentifiedArm
from catseye.calibration.scara.points import Commands
from catseye.calibration.scara.prediction import inside_nodes, inside_range

_FEW = 8
"""Stretches of lines that a sentence lists."""


def outside_text(arm: IdentifiedArm, commands: Commands, lines: Sequence[int]) -> str:
    """Return a sentence about rows outside the identified range; empty when there are none.

    Args:
        commands: n rows.
        lines: line of each row in its file, or its segment.
    """
    outside = ~inside_range(arm, commands)
    if not outside.any():
        return ""
    parts = []
    for name, nodes, theta in (
        ("θ1", arm.layout.nodes1_rad, commands.theta1_rad),
        ("θ2", arm.layout.nodes2_rad, commands.theta2_rad),
    ):
        beyond = ~inside_nodes(nodes, theta)
        if beyond.any():
            low, high = np.rad2deg([nodes[0], nodes[-1]])
            reached = np.rad2deg([theta[beyond].min(), theta[beyond].max()])
            parts.append(
                f"{name} ({reached[0]:.2f}°…{reached[1]:.2f}°) beyond its nodes {low:g}°…{high:g}° in "
                f"{lines_text(lines, beyond)}"
            )
    return (
        f"{int(outside.sum())} of {outside.size} rows lie outside the identified range and are left without numbers, "
        f"as a map is never extrapolated: {'; '.join(parts)}; identify with nodes that enclose them"
    )


def lines_text(lines: Sequence[int], chosen: Bools) -> str:
    """Return the chosen lines of a file, or segments of a drawing, as stretches."""
    rows = np.flatnonzero(chosen)
    word = place_word(lines)
    if word == "segment":
        rows = np.array(sorted({lines[row] for row in rows.tolist()}), dtype=np.int64)
        lines = range(int(rows[-1]) + 1)
    stretches = np.split(rows, np.flatnonzero(np.diff(rows) > 1) + 1)
    texts = [
        f"{lines[stretch[0]]}" if stretch.size == 1 else f"{lines[stretch[0]]}–{lines[stretch[-1]]}"
        for stretch in stretches
    ]
    shown = ", ".join(texts[:_FEW]) + (", …" if len(texts) > _FEW else "")
    return f"{word if rows.size == 1 else f'{word}s'} {shown}"


def place_word(lines: Sequence[int]) -> str:
    """Return what the numbers of rows count."""
    return "segment" if isinstance(lines, SegmentNumbers) else "line"
