"""J4 that points at a reflector, against the plane computed with complex numbers."""

import cmath
import math
from typing import cast

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from catseye.app.protocol.scara.layout import Layout
from catseye.app.tui.scara.pointing import pointing_j4_deg, turn_of_j4
from tests.unit.app.tui.scripted_bench import bench_status

LAYOUT = cast(Layout, bench_status().layout)
PLACES = {"P1": 650.0 - 400.0j, "P2": 680.0 + 0.0j, "P3": 640.0 + 380.0j}


@given(
    st.floats(-170, 170),
    st.floats(-145, 145),
    st.floats(-360, 360),
    st.sampled_from(sorted(PLACES)),
    st.floats(-20, 20),
)
def test_the_beam_goes_through_the_reflector(
    one: float, two: float, four: float, name: str, zero: float
) -> None:
    axis = 325.0 * cmath.exp(1j * math.radians(one)) + 225.0 * cmath.exp(1j * math.radians(one + two))
    assume(abs(PLACES[name] - axis) > 10.0)
    j4 = pointing_j4_deg(LAYOUT.model_copy(update={"theta40_deg": zero}), [one, two, 50.0, four], name)
    assert j4 is not None
    assert -360.0 <= j4 <= 360.0
    beam = cmath.exp(1j * math.radians(one + two + j4 + zero))
    towards = (PLACES[name] - axis) / abs(PLACES[name] - axis)
    assert beam == pytest.approx(towards, abs=1e-9)
    others = (j4 - 360.0, j4 + 360.0)
    assert all(abs(j4 - four) <= abs(other - four) + 1e-9 for other in others if -360.0 <= other <= 360.0)


def test_what_the_limits_do_not_allow_is_not_asked_for() -> None:
    layout = LAYOUT.model_copy(update={"limits_deg": {**LAYOUT.limits_deg, "j4": (-10.0, 10.0)}})
    assert pointing_j4_deg(layout, [0.0, 90.0, 50.0, 0.0], "P1") is None
    assert pointing_j4_deg(layout, [0.0, 0.0, 50.0, 0.0], "P2") == pytest.approx(0.0)
    assert pointing_j4_deg(layout, [0.0, 0.0, 50.0, 0.0], "P9") is None


@given(st.floats(-720, 720))
def test_a_turn_is_split_into_steps_that_the_engine_takes(by_deg: float) -> None:
    steps = turn_of_j4(by_deg)
    assert math.fsum(step.by for step in steps) == pytest.approx(by_deg)
    assert all(step.joint == "j4" and abs(step.by) <= 90.0 for step in steps)
