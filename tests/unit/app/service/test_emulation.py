"""The emulated bench of a cell file."""

import tomllib

import pytest

from catseye.app.cell.model import Cell
from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.service.scara.emulation import emulation_config


def cell(alignment: str = "", optics: str = "") -> Cell:
    document = tomllib.loads(TEMPLATE)
    document["alignment"] = tomllib.loads(alignment)
    document["optics"] |= tomllib.loads(optics)
    return Cell.model_validate(document)


@pytest.mark.parametrize(
    ("senses", "stage", "level"),
    [
        ("", 0.25, 1.5),
        ('stage_clockwise = "-y"', -0.25, 1.5),
        ('level_clockwise = "down"', 0.25, -1.5),
    ],
)
def test_screws_act_as_the_cell_file_says(senses: str, stage: float, level: float) -> None:
    given = cell(f"stage_mm_per_turn = 0.25\nlevel_mrad_per_turn = 1.5\n{senses}")
    screws = emulation_config(given, 1.0, 0, None).screws
    assert (screws.stage_mm_per_turn, screws.level_mrad_per_turn) == (stage, level)
    turned = screws.reversed()
    assert (turned.stage_mm_per_turn, turned.level_mrad_per_turn) == (-stage, -level)


def test_one_reflector_is_carried_where_the_cell_file_says_so() -> None:
    assert not emulation_config(cell(), 1.0, 0, None).one_reflector
    assert emulation_config(cell(optics="one_reflector = true"), 1.0, 0, None).one_reflector
