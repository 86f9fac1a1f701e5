"""What an axis of an arm shows of its value."""

import pytest

from catseye.app.protocol.bench import AxisName


@pytest.mark.parametrize(("unit", "shown"), [("deg", "A1 0.00°"), ("mm", "A1 0.0 mm")])
def test_a_value_that_rounds_to_zero_has_no_sign(unit: str, shown: str) -> None:
    assert AxisName.model_validate({"name": "A1", "unit": unit}).text(-0.001) == shown
