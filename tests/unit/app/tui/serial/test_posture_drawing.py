"""Both views of an arm against plain projections."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.app.protocol.posture import Limb, Place, Posture
from catseye.app.tui.serial.posture_drawing import FROM_ABOVE, draw_posture, from_the_side, scaled
from catseye.app.tui.widgets.braille import Canvas
from tests.unit.app.tui.widgets.dots import dots_of

lengths_mm = st.floats(-3000.0, 3000.0)
places = st.tuples(lengths_mm, lengths_mm, lengths_mm)


def arm(*joints_mm: Place, heading_deg: float = 0.0, limbs: tuple[Limb, ...] = ()) -> Posture:
    return Posture(joints_mm=joints_mm, heading_deg=heading_deg, limbs=limbs, table_z_mm=-10_000.0)


ELBOW = arm((0.0, 0.0, 0.0), (0.0, 0.0, 1000.0), (600.0, 800.0, 1000.0), heading_deg=53.13010235)
"""Upright, then level along a direction of 3 to 4."""


def text_of(posture: Posture, columns: int, rows: int, moving: int | None = None) -> list[str]:
    return ["".join(text for text, _ in line) for line in draw_posture(posture, moving, columns, rows)]


def test_views_are_projections_along_the_arm_and_from_above() -> None:
    assert from_the_side(ELBOW).plane_mm(ELBOW.joints_mm[2]) == pytest.approx((1000.0, 1000.0))
    assert FROM_ABOVE.plane_mm(ELBOW.joints_mm[2]) == (600.0, 800.0)


@given(
    st.lists(places, min_size=2, max_size=7), st.integers(8, 120), st.integers(4, 50), st.floats(-180, 180)
)
def test_every_joint_has_room_at_one_scale(
    joints_mm: list[Place], columns: int, rows: int, heading_deg: float
) -> None:
    posture = arm(*joints_mm, heading_deg=heading_deg)
    canvas = Canvas(columns, rows)
    for view in (from_the_side(posture), FROM_ABOVE):
        drawn = scaled(view, posture, canvas)
        for place in posture.joints_mm:
            x, y = drawn.dot(place)
            assert -0.5 <= x <= canvas.width - 0.5
            assert -0.5 <= y <= canvas.height - 0.5
        right = tuple(a + 100.0 * b for a, b in zip(joints_mm[0], view.across, strict=True))
        above = tuple(a + 100.0 * b for a, b in zip(joints_mm[0], view.upwards, strict=True))
        x0, y0 = drawn.dot(joints_mm[0])
        assert drawn.dot((right[0], right[1], right[2]))[0] - x0 == pytest.approx(100.0 / drawn.mm_per_dot)
        assert y0 - drawn.dot((above[0], above[1], above[2]))[1] == pytest.approx(100.0 / drawn.mm_per_dot)


def test_the_scale_stays_while_the_arm_moves_little() -> None:
    canvas = Canvas(40, 20)
    near = arm((0.0, 0.0, 0.0), (0.0, 0.0, 900.0), (900.0, 0.0, 900.0))
    moved = arm((0.0, 0.0, 0.0), (0.0, 0.0, 900.0), (890.0, 0.0, 930.0))
    assert scaled(FROM_ABOVE, near, canvas) == scaled(FROM_ABOVE, moved, canvas)


def test_a_body_is_outlined_by_its_radius() -> None:
    limb = Limb(name="beam", start_mm=(0.0, 0.0, 500.0), end_mm=(1000.0, 0.0, 500.0), radius_mm=200.0)
    posture = arm((0.0, 0.0, 500.0), (1000.0, 0.0, 500.0), limbs=(limb,))
    view = scaled(from_the_side(posture), posture, Canvas(40, 12))
    dots = dots_of(text_of(posture, 40, 12))
    for x_mm, z_mm in ((300.0, 700.0), (700.0, 700.0), (300.0, 300.0), (1200.0, 500.0), (-200.0, 500.0)):
        x, y = view.dot((x_mm, 0.0, z_mm))
        assert any(math.dist((x, y), dot) <= 1.0 for dot in dots), (x_mm, z_mm)
    x, y = view.dot((500.0, 0.0, 600.0))
    assert all(math.dist((x, y), dot) > 1.0 for dot in dots)


@pytest.mark.parametrize(
    ("columns", "rows", "side", "above"), [(60, 12, 1, 1), (40, 24, 1, 1), (40, 12, 1, 0), (0, 0, 0, 0)]
)
def test_views_share_the_room_that_there_is(columns: int, rows: int, side: int, above: int) -> None:
    text = text_of(ELBOW, columns, rows)
    assert len(text) == rows
    assert all(len(line) == columns for line in text)
    whole = "\n".join(text)
    assert (whole.count("↑Z"), whole.count("↑Y →X")) == (side, above)


def test_the_moving_joint_and_the_flange_are_marked() -> None:
    whole = "\n".join(text_of(ELBOW, 40, 12, moving=0))
    assert ("●" in whole, "◎" in whole) == (True, True)
    assert "●" not in "\n".join(text_of(ELBOW, 40, 12))
