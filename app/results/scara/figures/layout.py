"""The bench from above: commands, reflectors, what hides them, the arm, the path (Figs 5 and 7)."""

import math

import numpy as np

from catseye.app.results.figures import Axis, Figure, Line, Mark, Panel, Points, Role, Shape, Text, columns
from catseye.app.results.numbers import counted
from catseye.app.results.scara.layout import Scene, Target
from catseye.calibration.scara.planar import forward

_FIELD_MM = 130.0
"""Radius of the wedge that shows where a reflector looks."""

_ORIGIN = (0.0, 0.0)


def layout_figure(scene: Scene) -> Figure:
    """Return the bench in the plane of the arm."""
    marks = [
        *reach_marks(scene),
        Points(*columns(scene.commands_mm), Role.COMMAND, "command positions", size=3.5),
    ]
    if scene.path_mm is not None:
        marks.append(Line(*columns(scene.path_mm), Role.CONVENTIONAL, "validation path", width=2.2))
    for place, target in enumerate(scene.targets):
        marks += target_marks(scene, target, place)
    aim = scene.targets[0] if scene.targets else None
    arm = arm_marks(scene, scene.pose_rad, aim, "arm at one pose")
    panel = Panel("", Axis("X / mm"), Axis("Y / mm"), (*marks, *arm), equal=True)
    return Figure("layout", "Layout of the bench", _caption(scene), ((panel,),), aspect=0.66, legend="right")


def _caption(scene: Scene) -> str:
    caption = "The bench from above, with the arm at one pose and the beam to the first reflector."
    if scene.column_radius_mm is None:
        return caption
    blind = any(len(target.blind_mm) for target in scene.targets)
    seen = "Open symbols: commands that cannot see that reflector." if blind else "No command is blind."
    return f"{caption} Wedges: field that a reflector looks into. {seen}"


def reach_marks(scene: Scene) -> list[Mark]:
    """Return how far the arm reaches, and its base."""
    outer, inner = scene.link1_mm + scene.link2_mm, abs(scene.link1_mm - scene.link2_mm)
    marks: list[Mark] = [
        Shape(_ORIGIN, (radius, radius), Role.MUTED, label, dashed=True)
        for radius, label in ((outer, "reach of the arm"), (inner, ""))
    ]
    if scene.column_radius_mm:
        column = (scene.column_radius_mm, scene.column_radius_mm)
        marks.append(Shape(_ORIGIN, column, Role.COLUMN, "base column", filled=True))
    return marks


def target_marks(scene: Scene, target: Target, place: int) -> list[Mark]:
    """Return a reflector, the field that it looks into, and the commands that do not see it."""
    x, y = (float(value) for value in target.xy_mm)
    marks: list[Mark] = []
    if target.facing_deg is not None and scene.field_half_angle_deg is not None:
        low, high = (target.facing_deg + sign * scene.field_half_angle_deg for sign in (-1.0, 1.0))
        field = (_FIELD_MM, _FIELD_MM)
        marks.append(Shape((x, y), field, place, filled=True, from_deg=low, to_deg=high))
    marks += [
        Points(np.array([x]), np.array([y]), place, f"reflector {target.name}", size=8.0),
        Text(target.name, (x, y), place),
    ]
    if len(target.blind_mm):
        # Symbols of several reflectors at one command stand inside each other.
        label = f"blind for {target.name}: {counted(len(target.blind_mm), 'position')}"
        marks.append(Points(*columns(target.blind_mm), place, label, size=6.0 + 3.0 * place, hollow=True))
    return marks


def arm_marks(scene: Scene, pose_rad: tuple[float, float], aim: Target | None, label: str) -> list[Mark]:
    """Return the arm at a pose, with the beam to a reflector."""
    theta1, theta2 = pose_rad
    tool = forward(np.array(theta1), np.array(theta2), scene.link1_mm, scene.link2_mm)
    elbow = scene.link1_mm * np.array([math.cos(theta1), math.sin(theta1)])
    joints = np.array([np.zeros(2), elbow, tool])
    marks: list[Mark] = [
        Line(*columns(joints), Role.ARM, label, width=7.0, faint=True),
        Points(*columns(joints), Role.ARM, size=5.5),
    ]
    if aim is not None:
        beam = np.array([tool, aim.xy_mm])
        marks.append(Line(*columns(beam), Role.BEAM, "laser beam", "dash-dotted", 1.0))
    return marks
