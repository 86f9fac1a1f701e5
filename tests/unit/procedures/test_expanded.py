"""An uncertainty is shown expanded, k = 2, and only there."""

from catseye.app.results import numbers
from catseye.procedures.kit.expanded import EXPANDED, expanded_text


def test_u_is_doubled_once() -> None:
    assert expanded_text(0.08, 0.03, 2) == "0.08 ± 0.06"
    assert expanded_text(0.04, 0.0125, 3, signed=True) == "+0.040 ± 0.025"


def test_there_is_one_coverage_factor() -> None:
    assert EXPANDED == 2.0
    assert numbers.EXPANDED is EXPANDED
