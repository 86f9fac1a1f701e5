"""The report of a path that the interferometer measured."""

from dataclasses import replace

import numpy as np
import pytest

from catseye.app.render.mpl import drawn
from catseye.app.results.scara.arm_report import verdict
from catseye.app.results.scara.distance_report import distance_figure
from catseye.app.results.scara.distance_validation import DistancePath, DistanceValidation, ModelOnDistances
from catseye.app.results.scara.findings import Findings
from catseye.calibration.scara.points import Commands, Points
from tests.unit.app.render.page_reader import read_page
from tests.unit.app.results.scara import sample

Y_MM = np.array([-20.0, 0.0, 20.0, 20.0, 0.0, -20.0])


def distances(last_um: float = 10.0, probability: float | None = 0.3) -> DistanceValidation:
    """Return two models that leave 40 µm and what is given, the fourth row left out.

    Args:
        probability: of what the last model leaves.
    """
    still = np.zeros(6)
    states = np.ones(6, dtype=np.int64)
    points = Points(
        Commands(still, still, states, states),
        np.zeros(6, dtype=np.int64),
        np.array([0, 0, 0, 1, 1, 1], dtype=np.int64),
        still,
        None,
        ("P2",),
        (("P2", 0), ("P2", 1)),
    )
    compared = np.array([True, True, True, False, True, True])
    path = DistancePath(points, np.column_stack([np.full(6, 200.0), Y_MM]), np.repeat([1, -1], 3), compared)
    models = tuple(
        ModelOnDistances(
            name,
            np.where(compared, 1e-3 * um * np.array([1.0, -1.0, 1.0, 1.0, -1.0, 1.0]), np.nan),
            np.where(compared, 1e-3 * u_um, np.nan),
            {},
            chance,
        )
        for name, um, u_um, chance in (
            ("conventional", 40.0, 24.5, 1e-6),
            ("error-map", last_um, 6.5, probability),
        )
    )
    return DistanceValidation(path, compared, models, ("segment 1 of reflector P2 left out",))


@pytest.fixture(scope="module")
def text() -> str:
    return sample.page(sample.Sheet("Path", sample.MADE, Findings(distances=distances())))


def test_the_page_has_figures_and_words_of_the_distances(text: str) -> None:
    page = read_page(text)
    assert "Validation path, measured by distances" in page.headings
    assert ("figure", "id", "figure-path-distances") in page.attributes
    for part in (
        "6 distances to P2 in 2 segments. 5 compared, 1 left out",
        "Y = −20 … 20 mm",
        "segment 1 of reflector P2 left out",
        "0.25",
        "49.0",
    ):
        assert part in text


@pytest.mark.parametrize(
    ("last_um", "probability", "kind", "short", "ratio", "chance"),
    [
        (10.0, 0.3, "good", "10.0 µm", "0.25", ", p = 0.30)."),
        (10.0, None, "good", "10.0 µm", "0.25", " rows compared)."),
        (
            10.0,
            1e-4,
            "attention",
            "10.0 µm, p < 0.001",
            "0.25",
            ", p < 0.001: more than the uncertainties explain).",
        ),
        (38.0, 0.3, "bad", "38.0 µm", "0.95", ", p = 0.30)."),
    ],
)
def test_the_verdict_follows_what_is_left_and_its_test(
    last_um: float, probability: float | None, kind: str, short: str, ratio: str, chance: str
) -> None:
    left = distances(last_um, probability)
    findings = replace(sample.whole().findings, validation=None, distances=left)
    (found,) = [one for one in verdict(findings) if one.text.startswith("On distances along a path")]
    assert found.sign == kind
    assert found.short == f"conventional model 40.0 µm → error map {short}"
    assert f"leaves {last_um:.1f} µm rms, the conventional model 40.0 µm: ratio {ratio} (5 of 6" in found.text
    assert found.text.endswith(chance)
    assert not any("has not been checked" in one.text for one in verdict(findings))


def test_rows_that_are_not_compared_are_not_drawn() -> None:
    figure = drawn(distance_figure(distances()))
    lines = [line for axes in figure.axes for line in axes.get_lines()]
    shown = [tuple(np.asarray(line.get_xdata()).tolist()) for line in lines]
    assert shown.count((-20.0, 0.0, 20.0)) == 2
    assert shown.count((0.0, -20.0)) == 2


@pytest.fixture(scope="module")
def without_u() -> str:
    positions = sample.validation()
    silent = replace(positions.path, u_mm=np.full(positions.path.u_mm.size, np.nan))
    findings = Findings(validation=replace(positions, path=silent))
    return sample.page(sample.Sheet("Path", sample.MADE, findings))


def test_an_instrument_stating_no_uncertainty_is_described_so(without_u: str) -> None:
    assert "an independent instrument that states no uncertainty." in without_u
    assert "nan" not in without_u.lower()
