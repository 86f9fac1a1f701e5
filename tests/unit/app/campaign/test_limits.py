"""Values of a document against their limits."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from catseye.app.campaign.limits import judged
from catseye.app.campaign.model import Limit

RESULT = {
    "fit": {"rms_um": 9.5, "rejected": []},
    "link1_mm": {"value": 325.1, "u": 0.02},
    "reflectors": [
        {"name": "P1", "x_mm": {"value": 650.0, "u": 0.05}},
        {"name": "P2", "x_mm": {"value": 680.0, "u": None}},
    ],
}


def limit(value: str, **rest: float) -> Limit:
    return Limit.model_validate({"value": value, **rest})


def test_a_plain_number_is_judged() -> None:
    assert judged(limit("fit.rms_um", max=10.0), RESULT).met
    beyond = judged(limit("fit.rms_um", max=9.0), RESULT)
    assert (beyond.met, beyond.found, beyond.u) == (False, 9.5, None)
    assert beyond.text == "fit.rms_um = 9.5, limit ≤ 9"


def test_a_value_with_its_uncertainty_is_judged() -> None:
    found = judged(limit("link1_mm", min=325.0, max=325.2), RESULT)
    assert (found.met, found.found, found.u) == (True, 325.1, 0.02)
    assert judged(limit("link1_mm.u", max=0.02), RESULT).met


def test_the_worst_of_several_values_stands_for_all() -> None:
    found = judged(limit("reflectors.*.x_mm", min=660.0), RESULT)
    assert (found.value, found.found, found.met) == ("reflectors.0.x_mm", 650.0, False)


def test_a_guard_asks_for_room_to_spare() -> None:
    assert judged(limit("link1_mm", max=325.15, guard_k=2.0), RESULT).met
    assert not judged(limit("link1_mm", max=325.13, guard_k=2.0), RESULT).met
    unstated = judged(limit("reflectors.1.x_mm", max=1000.0, guard_k=2.0), RESULT)
    assert not unstated.met
    assert "no uncertainty is stated" in unstated.text


def test_a_missing_value_names_those_there_are() -> None:
    found = judged(limit("fit.sigma", max=1.0), RESULT)
    assert not found.met
    assert "fit.rms_um" in found.text
    assert "reflectors.*.x_mm" in found.text
    assert not judged(limit("fit.sigma", max=1.0), None).met


def test_null_meets_no_limit() -> None:
    assert not judged(limit("link1_mm", max=1.0), {"link1_mm": {"value": None, "u": None}}).met


@pytest.mark.parametrize("values", [{}, {"min": 2.0, "max": 1.0}, {"max": float("nan")}])
def test_a_limit_has_to_limit(values: dict[str, float]) -> None:
    with pytest.raises(ValidationError):
        limit("a", **values)


@given(
    st.floats(-1e6, 1e6), st.floats(0.0, 1e3), st.floats(-1e6, 1e6), st.floats(0.0, 1e6), st.floats(0.0, 5.0)
)
def test_the_guarded_interval_decides(
    value: float, u: float, low: float, width: float, guard_k: float
) -> None:
    found = judged(limit("x", min=low, max=low + width, guard_k=guard_k), {"x": {"value": value, "u": u}})
    inside = low <= value - guard_k * u and value + guard_k * u <= low + width
    # Rounding decides where the interval ends exactly at its limit.
    near = min(abs(value - guard_k * u - low), abs(low + width - value - guard_k * u)) < 1e-6
    assert near or found.met == inside
