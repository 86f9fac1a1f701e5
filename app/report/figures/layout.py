"""The bench from above: commands, reflectors, what hides them, the arm, the path (Figs 5 and 7)."""

import math

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Wedge

from catseye.app.report.figures.canvas import CONVENTIONAL, MUTED, STYLE, WIDTH_IN, series
from catseye.app.report.numbers import counted
from catseye.app.report.scene import Scene, Target
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.planar import forward

_FIELD_MM = 130.0
"""Radius of the wedge that shows where a reflector looks."""


@rc_context(STYLE)
def layout_figure(scene: Scene) -> Figure:
    """Draw the bench in the plane of the arm."""
    figure = Figure(figsize=(WIDTH_IN, 5.3))
    axes = figure.subplots()
    axes.set_aspect("equal")
    _reach(axes, scene)
    axes.plot(*scene.commands_mm.T, ".", color="#3c4148", markersize=3.5, label="command positions")
    if scene.path_mm is not None:
        axes.plot(*scene.path_mm.T, color=CONVENTIONAL, linewidth=2.2, label="validation path")
    for index, target in enumerate(scene.targets):
        _target(axes, scene, target, index)
    _arm(axes, scene)
    axes.set_xlabel("X / mm")
    axes.set_ylabel("Y / mm")
    axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0))
    return figure


def _reach(axes: Axes, scene: Scene) -> None:
    outer, inner = scene.link1_mm + scene.link2_mm, abs(scene.link1_mm - scene.link2_mm)
    for radius, label in ((outer, "reach of the arm"), (inner, "")):
        axes.add_patch(
            Circle(
                (0.0, 0.0), radius, fill=False, linestyle=(0, (5, 4)), color=MUTED, linewidth=0.9, label=label
            )
        )
    if scene.column_radius_mm:
        axes.add_patch(
            Circle(
                (0.0, 0.0),
                scene.column_radius_mm,
                facecolor="#d7dbe0",
                edgecolor=MUTED,
                hatch="////",
                linewidth=0.8,
                label="base column",
            )
        )


def _target(axes: Axes, scene: Scene, target: Target, index: int) -> None:
    colour, marker = series(index)
    x, y = target.xy_mm
    if target.facing_deg is not None and scene.field_half_angle_deg is not None:
        low, high = (
            target.facing_deg - scene.field_half_angle_deg,
            target.facing_deg + scene.field_half_angle_deg,
        )
        axes.add_patch(Wedge((x, y), _FIELD_MM, low, high, facecolor=colour, alpha=0.13))
        axes.add_patch(Wedge((x, y), _FIELD_MM, low, high, fill=False, edgecolor=colour, linewidth=0.7))
    axes.plot(x, y, marker, color=colour, markersize=8.0, label=f"reflector {target.name}")
    axes.annotate(
        target.name, (x, y), xytext=(8, 4), textcoords="offset points", color=colour, fontweight="bold"
    )
    if len(target.blind_mm):
        axes.plot(
            *target.blind_mm.T,
            marker,
            color=colour,
            markersize=6.0 + 3.0 * index,
            markerfacecolor="none",
            label=f"blind for {target.name}: {counted(len(target.blind_mm), 'position')}",
        )


def _arm(axes: Axes, scene: Scene) -> None:
    """Draw the arm at the pose in the middle of the commands, with the beam to the first reflector."""
    theta1, theta2 = scene.pose_rad
    tool = _position(theta1, theta2, scene)
    elbow = scene.link1_mm * np.array([math.cos(theta1), math.sin(theta1)])
    joints = np.array([np.zeros(2), elbow, tool])
    axes.plot(
        *joints.T, color="#59636e", linewidth=7.0, alpha=0.45, solid_capstyle="round", label="arm at one pose"
    )
    axes.plot(*joints.T, "o", color="white", markeredgecolor="#59636e", markersize=5.5)
    if scene.targets:
        beam = np.array([tool, scene.targets[0].xy_mm])
        axes.plot(*beam.T, color="#e00000", linewidth=1.0, linestyle="-.", label="laser beam")


def _position(theta1_rad: float, theta2_rad: float, scene: Scene) -> Floats:
    return forward(np.array(theta1_rad), np.array(theta2_rad), scene.link1_mm, scene.link2_mm)
