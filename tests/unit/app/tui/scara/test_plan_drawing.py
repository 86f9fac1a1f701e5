"""The bench from above against the plane computed with complex numbers."""

import cmath
import math
from typing import Any, cast

import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.app.protocol.scara.layout import Layout
from catseye.app.tui.scara.plan_drawing import BEAM_LOST, BEAM_OK, draw_plan, pose_of, view_of
from catseye.app.tui.widgets.braille import Canvas
from tests.unit.app.tui.scripted_bench import BENCH, bench_status
from tests.unit.app.tui.widgets.dots import dots_of

LAYOUT = cast(Layout, bench_status().layout)
JOINTS = BENCH["robot"]["joints"]
angles = st.floats(-170.0, 170.0)


def arm_by_hand(joints: list[float]) -> tuple[complex, complex]:
    """Return elbow and J4 axis, mm."""
    elbow = 325.0 * cmath.exp(1j * math.radians(joints[0]))
    return elbow, elbow + 225.0 * cmath.exp(1j * math.radians(joints[0] + joints[1]))


def alone(**changes: Any) -> Layout:
    """Return a bench without reflectors, column and limits: what is drawn is the arm."""
    limits = {"j1": (-180.0, 180.0), "j2": (-180.0, 180.0), "j4": (-360.0, 360.0)}
    bare = {"reflectors": (), "column_radius_mm": 0.0, "aim": None, "limits_deg": limits}
    return LAYOUT.model_copy(update={**bare, **changes})


@given(angles, angles, angles)
def test_pose(one: float, two: float, four: float) -> None:
    joints = [one, two, 50.0, four]
    pose = pose_of(LAYOUT.model_copy(update={"theta40_deg": 12.5}), joints)
    elbow, place = arm_by_hand(joints)
    assert complex(*pose.elbow_mm) == pytest.approx(elbow, abs=1e-9)
    assert complex(*pose.place_mm) == pytest.approx(place, abs=1e-9)
    beam = cmath.exp(1j * math.radians(one + two + four + 12.5))
    assert cmath.exp(1j * pose.beam_rad) == pytest.approx(beam, abs=1e-9)


@given(st.integers(20, 120), st.integers(8, 50))
def test_both_axes_have_one_scale_and_everything_has_room(columns: int, rows: int) -> None:
    canvas = Canvas(columns, rows)
    view = view_of(LAYOUT, canvas)
    x0, y0 = view.dot(0.0, 0.0)
    x1, y1 = view.dot(100.0, 100.0)
    assert x1 - x0 == pytest.approx(100.0 / view.mm_per_dot)
    assert y0 - y1 == pytest.approx(100.0 / view.mm_per_dot)
    corners = [
        (-550.0, -550.0),
        (550.0, 550.0),
        *((each.x_mm, each.y_mm) for each in LAYOUT.reflectors),
    ]
    for place in corners:
        x, y = view.dot(*place)
        assert -0.5 <= x <= canvas.width - 0.5
        assert -0.5 <= y <= canvas.height - 0.5


@given(angles, angles)
def test_every_dot_of_the_arm_lies_on_it(one: float, two: float) -> None:
    """Read back in mm, each dot is at most the joint's circle and half a dot away from the nearer link."""
    joints = [one, two, 50.0, 0.0]
    canvas = draw_plan(alone(), joints, None, 80, 30)
    view = view_of(alone(), canvas)
    inked = list(canvas.lines())
    elbow, place = arm_by_hand(joints)
    dots = _dots_with_ink(inked, "arm")
    assert dots
    for x, y in dots:
        at = complex(view.left_mm + x * view.mm_per_dot, view.top_mm - y * view.mm_per_dot)
        off_mm = min(_distance(at, 0j, elbow), _distance(at, elbow, place))
        # A cell has one ink: dots of the beam in a cell of the arm count as the arm's.
        beam_mm = _distance(at, place, place + 2000.0 * cmath.exp(1j * math.radians(one + two)))
        assert min(off_mm, beam_mm) <= 2.3 * view.mm_per_dot
    for joint in (0j, elbow, place):
        place_dot = view.dot(joint.real, joint.imag)
        assert any(math.dist(dot, place_dot) <= 2.3 for dot in dots)


def _dots_with_ink(lines: list[list[tuple[str, str]]], ink: str) -> set[tuple[int, int]]:
    return dots_of("".join(text if of == ink else " " * len(text) for text, of in line) for line in lines)


def _distance(at: complex, start: complex, end: complex) -> float:
    share = ((at - start) * (end - start).conjugate()).real / abs(end - start) ** 2
    return abs(at - start - min(max(share, 0.0), 1.0) * (end - start))


def inks(beam_ok: bool | None) -> set[str]:
    canvas = draw_plan(LAYOUT, JOINTS, beam_ok, 70, 20)
    return {ink for line in canvas.lines() for _, ink in line}


def test_a_lost_beam_has_another_ink_and_is_dashed() -> None:
    assert BEAM_OK in inks(beam_ok=True)
    assert BEAM_LOST not in inks(beam_ok=True)
    assert BEAM_LOST in inks(beam_ok=False)
    layout = alone()
    full = dots_of(draw_plan(layout, [0.0, 0.0, 50.0, 90.0], True, 70, 20).plain())
    dashed = dots_of(draw_plan(layout, [0.0, 0.0, 50.0, 90.0], False, 70, 20).plain())
    assert dashed < full


def test_the_beam_that_is_aimed_ends_at_its_reflector() -> None:
    canvas = draw_plan(LAYOUT, JOINTS, True, 100, 40)
    view = view_of(LAYOUT, canvas)
    beam = _dots_with_ink(list(canvas.lines()), BEAM_OK)
    x, y = view.dot(650.0, -400.0)
    lowest = max(beam, key=lambda dot: dot[1])
    assert math.dist(lowest, (x, y)) <= 4.0


def test_the_length_at_the_edge_is_to_scale() -> None:
    canvas = draw_plan(alone(), None, None, 100, 40)
    view = view_of(alone(), canvas)
    words = "".join(text for text, _ in list(canvas.lines())[-1])
    labelled_mm = float(words.split(" mm", maxsplit=1)[0].split()[-1])
    drawn = {x for x, y in dots_of(canvas.plain()) if y == canvas.height - 2}
    assert (max(drawn) - min(drawn)) * view.mm_per_dot == pytest.approx(labelled_mm, abs=view.mm_per_dot)


def test_joint_limits_are_arcs_where_there_is_room() -> None:
    layout = alone(limits_deg={**alone().limits_deg, "j1": (-90.0, 90.0)})
    canvas = draw_plan(layout, None, None, 100, 40)
    view = view_of(layout, canvas)
    x0, y0 = view.dot(0.0, 0.0)
    arc = _dots_with_ink(list(canvas.lines()), "range")
    assert arc
    radius = 0.2 * 325.0 / view.mm_per_dot
    for x, y in arc:
        assert x >= x0 - 1.0
        assert math.dist((x, y), (x0, y0)) == pytest.approx(radius, abs=1.0)
    assert not _dots_with_ink(list(draw_plan(layout, None, None, 40, 10).lines()), "range")


@pytest.mark.parametrize("size", [(0, 0), (1, 1), (5, 2), (300, 3)])
def test_any_size_is_drawn(size: tuple[int, int]) -> None:
    columns, rows = size
    lines = list(draw_plan(LAYOUT, JOINTS, True, columns, rows).lines())
    assert len(lines) == rows
    assert {sum(len(text) for text, _ in line) for line in lines} <= {columns}
