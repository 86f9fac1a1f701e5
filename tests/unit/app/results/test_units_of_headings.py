"""Units that the headings of other programs state."""

import pytest

from catseye.app.results.mapping import unit_of


@pytest.mark.parametrize(
    ("heading", "unit"),
    [
        ("x_meas_um", "um"),
        ("X_act_m", "m"),
        ("X [MM]", "mm"),
        ("Abstand (µm)", "um"),
        ("angle [Deg]", "deg"),
        ("X/m", "m"),
        ('angle ["]', "arcsec"),
        ("X [ft]", "ft"),
        ("X", ""),
    ],
)
def test_the_last_word_of_a_heading_is_its_unit(heading: str, unit: str) -> None:
    assert unit_of(heading) == unit
