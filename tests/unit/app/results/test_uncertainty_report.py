"""The section about where uncertainties come from."""

import re
import tomllib
from functools import cache

import numpy as np

from catseye.app.cell.model import Cell
from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.render.html import section_html
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
    return [
        cells_of(row)
        for row in re.findall(
            r"<tr>(.*?)</tr>",
            section_html(uncertainty_section(result().uncertainty, cell().uncertainty.contributor), iter(())),
        )
    ]


def test_every_contributor_has_its_value_and_correlation() -> None:
    table = {row[0]: row[1:] for row in rows() if len(row) == 7}
    assert table["repeatability of the robot"] == ["position", "10 µm", "normal", "reading", "–", "–"]
    assert table["radial error motion of J4"] == ["radial", "10 µm", "normal", "axis-angle", "J4", "–"]
    assert table["wavelength correction"] == ["scale", "0.256 ppm", "normal", "common", "–", "–"]
    assert table["beam direction, J1"] == ["direction", "0.717 mrad", "normal", "reading", "–", "–"]


def test_the_shares_of_a_result_are_all_of_its_variance() -> None:
    (row,) = [row for row in rows() if row[0].startswith("L1 / µm")]
    shares = [0.0 if text == "–" else float(text) for text in row[2:]]
    assert abs(sum(shares) - 100.0) < 0.3


def test_without_result_and_cell_there_is_no_section() -> None:
    assert not uncertainty_section(None, []).blocks
