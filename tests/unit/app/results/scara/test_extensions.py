"""What --extend names becomes terms, each once, and what it cannot name is refused with what it can."""

import pytest

from catseye.app.errors import UsageError
from catseye.app.results.scara.identify import parse_extensions
from catseye.calibration.scara.extension import Term


def test_words_stand_for_these_terms() -> None:
    names = {
        word: [term.name for term in parse_extensions([word])] for word in ("crosstalk", "j4", "thermal")
    }
    assert names["crosstalk"][:4] == ["Δθ1 cos θ2", "Δθ1 sin θ2", "Δθ1 cos 2θ2", "Δθ1 sin 2θ2"]
    assert names["crosstalk"][4:] == ["Δθ2 cos θ1", "Δθ2 sin θ1", "Δθ2 cos 2θ1", "Δθ2 sin 2θ1"]
    assert names["j4"] == [f"Δd {part} {order}θ4" for order in range(2, 7) for part in ("cos", "sin")]
    assert names["thermal"] == ["ΔL1 t", "ΔL2 t"]


def test_periodic_names_joint_and_order() -> None:
    assert parse_extensions(["periodic1:36", "periodic2:2000"]) == (
        Term("theta1", "theta1", "cos", 36),
        Term("theta1", "theta1", "sin", 36),
        Term("theta2", "theta2", "cos", 2000),
        Term("theta2", "theta2", "sin", 2000),
    )


def test_extensions_named_twice_are_taken_once() -> None:
    assert parse_extensions(["thermal", "periodic1:5", "thermal", "periodic1:5"]) == parse_extensions(
        ["thermal", "periodic1:5"]
    )
    assert parse_extensions([]) == ()


@pytest.mark.parametrize(
    "word", ["", "J4", "periodic", "periodic3:4", "periodic1:", "periodic1:-4", "periodic1:4.5", "thermal "]
)
def test_unknown_words_are_refused_with_the_possible_ones(word: str) -> None:
    with pytest.raises(UsageError, match=r"crosstalk, j4, thermal, and periodic1:ORDER or periodic2:ORDER"):
        parse_extensions(["thermal", word])


@pytest.mark.parametrize("order", ["0", "2001", "9999"])
def test_orders_out_of_range_are_refused(order: str) -> None:
    with pytest.raises(UsageError, match=f"periodic2:{order}: the order has to be 1 to 2000"):
        parse_extensions([f"periodic2:{order}"])
