"""Links at 20 °C follow from what the runs have recorded."""

import tomllib
from typing import Any, cast

import pytest
from pydantic import ValidationError

from catseye.app.cell.model import Cell
from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.results.scara.material import with_reference_links
from catseye.app.store.reader import RunReader
from tests.unit.app.results.scara.sample import hand_made

_SENSOR = {"name": "on-link", "driver": "modbus-air", "endpoint": "tcp://127.0.0.1:10600"}
_STEEL = {"sensor": "on-link", "cte_per_k": 11.5e-6}


class Run:
    """A run with two points."""

    def __init__(self, *temperatures: float | None, material: dict[str, Any] | None = _STEEL) -> None:
        cell = {**tomllib.loads(TEMPLATE), "device": [_SENSOR]}
        cell |= {} if material is None else {"material": material}
        self.meta = {"configuration": cell}
        self._temperatures = temperatures

    def placed_rows(self, table: str) -> list[tuple[int, dict[str, object]]]:
        rows: list[dict[str, object]] = [
            {} if value is None else {"material_c": value} for value in self._temperatures
        ]
        return list(enumerate(rows if table == "points" else [], 1))


def readers(*runs: Run) -> list[RunReader]:
    return [cast("RunReader", run) for run in runs]


def test_links_are_given_at_20_degrees_too() -> None:
    result = hand_made()
    found = with_reference_links(result, readers(Run(21.0, 23.0), Run(22.0)))
    assert found.link1_20c_mm is not None
    assert found.link1_20c_mm.value == pytest.approx(result.link1_mm.value / (1.0 + 2.0 * 11.5e-6))
    assert found.link1_20c_mm.u > result.link1_mm.u
    assert found.material_c == pytest.approx(22.0)
    assert found.link1_mm == result.link1_mm


@pytest.mark.parametrize(
    "runs",
    [
        [],
        [Run(21.0, material=None)],
        [Run(21.0, None)],
        [Run(21.0), Run(21.0, material={**_STEEL, "cte_per_k": 23.6e-6})],
    ],
    ids=["no run", "no section", "a point without temperature", "two materials"],
)
def test_otherwise_nothing_is_added(runs: list[Run]) -> None:
    assert with_reference_links(hand_made(), readers(*runs)).link1_20c_mm is None


def test_a_sensor_that_is_not_there_is_refused() -> None:
    cell = {**tomllib.loads(TEMPLATE), "material": _STEEL}
    with pytest.raises(ValidationError, match=r"is not a \[\[device\]\]"):
        Cell.model_validate(cell)
