"""Where an axis stands within its range."""

import pytest

from catseye.app.protocol.bench import AxisRange
from catseye.app.tui.serial.range_bar import range_bar

AXIS = AxisRange(name="A2", unit="deg", low=-140.0, high=-40.0)


@pytest.mark.parametrize(
    ("value", "bar"),
    [
        (-140.0, "├●─────────┤"),
        (-90.1, "├────●─────┤"),
        (-40.0, "├─────────●┤"),
        (-141.0, "◀──────────┤"),
        (-39.0, "├──────────▶"),
        (None, "├··········┤"),
    ],
)
def test_values_are_shown_within_the_range(value: float | None, bar: str) -> None:
    assert range_bar(AXIS, value, 10) == bar


def test_a_range_without_length_shows_nothing() -> None:
    assert "●" not in range_bar(AxisRange(name="Z", unit="mm", low=5.0, high=5.0), 5.0, 10)
