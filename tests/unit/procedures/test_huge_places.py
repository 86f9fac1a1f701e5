"""Measured positions as large as any number are no reason for a warning of the arithmetic."""

import numpy as np

from catseye.procedures.scara.path.measured_path import misplaced


def test_positions_as_large_as_any_number_are_refused() -> None:
    commands_mm = np.array([[300.0, 0.0], [300.0, 100.0], [400.0, 100.0]])
    found = misplaced(commands_mm, np.array([[1e308, 0.0], [-1e308, 1e308], [1.0, 1e308]]))
    assert found is not None
    assert "times as far as the commands" in found.text
