"""The section about where uncertainties come from."""

import re
import tomllib
from functools import cache

import numpy as np
import pytest

from catseye.app.cell.model import Cell
from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.render.html import section_html
from catseye.app.render.labels import Labels
from catseye.app.results.model import Table
from catseye.app.results.scara.result import Result
from catseye.app.results.scara.result_of import result_of
from catseye.app.results.scara.uncertainty import by_jacobian
from catseye.app.results.uncertainty_report import uncertainty_section
from catseye.calibration.scara.budget import Budget
from tests.unit.calibration.scara.paper import (
    paper_points,
    random_truth,
)
from tests.unit.calibration.scara.samples import identified


@cache
def cell() -> Cell:
    return Cell.model_validate(tomllib.loads(TEMPLATE))


@cache
def result() -> Result:
    noise = np.random.default_rng(4).normal(0.0, 0.010, 1056)
    budget: Budget = cell().uncertainty.budget
    points = paper_points(random_truth(4), noise_mm=noise)
    found = identified(points, budget=budget)
    plain = result_of(found, (325.0, 225.0), ["run"], "catseye", "2026-01-01T00:00:00+00:00")
    return plain.model_copy(update={"uncertainty": by_jacobian(found).part})


def cells_of(row: str) -> list[str]:
    return [re.sub(r"<[^>]+>", "", cell_) for cell_ in re.findall(r"<t[dh][^>]*>(.*?)</t[dh]>", row)]


def rows() -> list[list[str]]:
    section = uncertainty_section(result().uncertainty, cell().uncertainty.contributor)
    html = section_html(section, iter(()), Labels(section.blocks))
    return [cells_of(row) for row in re.findall(r"<tr>(.*?)</tr>", html)]


def test_every_contributor_has_its_value_and_correlation() -> None:
    table = {row[0]: row[1:] for row in rows() if len(row) == 7}
    assert table["repeatability of the robot"] == ["position", "10 µm", "normal", "reading", "–", "–"]
    assert table["radial error motion of J4"] == ["radial", "10 µm", "normal", "axis-angle", "J4", "–"]
    assert table["wavelength correction"] == ["scale", "0.256 ppm", "normal", "common", "–", "–"]
    assert table["beam direction, J1"] == ["direction", "0.717 mrad", "normal", "reading", "–", "–"]


def test_the_shares_of_a_result_are_all_of_its_variance() -> None:
    section = uncertainty_section(result().uncertainty, [])
    (table,) = [one for one in section.blocks if isinstance(one, Table) and one.key == "contributions"]
    assert table.columns[1].title == "L1 / µm"
    assert table.rows[0][0] == "U"
    shares = [row[1] for row in table.rows[1:] if isinstance(row[1], float)]
    assert sum(shares) == pytest.approx(100.0, abs=0.3)
    assert {row[0] for row in table.rows[1:]} <= {one.name for one in cell().uncertainty.contributor}
    assert len(table.rows) > 5


def test_degrees_of_freedom_are_shown_only_where_they_are_finite() -> None:
    part = result().uncertainty
    assert part is not None
    endless = [one.model_copy(update={"degrees_of_freedom": None}) for one in part.intervals]
    few = [one.model_copy(update={"degrees_of_freedom": 7.0}) for one in part.intervals]
    heads = {
        name: [column.key for column in table.columns]
        for name, intervals in (("endless", endless), ("few", few))
        for table in uncertainty_section(part.model_copy(update={"intervals": intervals}), []).blocks
        if isinstance(table, Table) and table.key == "intervals"
    }
    assert "degrees_of_freedom" not in heads["endless"]
    assert heads["few"][-1] == "degrees_of_freedom"


def test_without_result_and_cell_there_is_no_section() -> None:
    assert not uncertainty_section(None, []).blocks
