"""Each number of a result appears with its unit, rounded to what is known of it."""

import math

import numpy as np
import pytest

from catseye.app.results.scara.result import Covariance
from catseye.app.results.scara.reversal import u_reversal_mdeg
from tests.unit.app.render.page_reader import Page, read_page
from tests.unit.app.results.scara import sample


@pytest.fixture(scope="module")
def page() -> Page:
    return read_page(sample.bare_page())


@pytest.fixture(scope="module")
def whole() -> Page:
    return read_page(sample.whole_page())


def test_links(page: Page) -> None:
    assert page.row("L1 / mm") == ["325.0", "324.9641", "0.0047"]
    assert page.row("L2 / mm") == ["225.0", "224.9985", "0.0044"]
    assert "L1 = 324.9641 mm (U = 4.7 µm), L2 = 224.9985 mm (U = 4.4 µm, k = 2)" in page.text


def test_maps(page: Page) -> None:
    heads = [row for row in page.rows if row[0] == "node / °"]
    assert [head[1] for head in heads] == ["Δθ1 +", "Δθ2 +"]
    nodes = [row for row in page.rows if row[0] == "−20"]
    assert nodes[0][1:] == ["−11.23", "1.22", "−21.11", "1.28", "+9.88"]
    assert nodes[1][1:] == ["−10.23", "1.22", "−21.11", "1.28", "+10.88"]
    assert page.row("0") == ["+3.46", "1.24", "−6.54", "1.30", "+10.00"]
    assert "J1 deviates by −21.1 to +7.8 mdeg" in page.text


def test_fit(page: Page) -> None:
    assert page.row("distances") == ["1056"]
    assert page.row("degrees of freedom") == ["1008"]
    assert page.row("rms of residuals / µm") == ["15.41"]
    assert page.row("σ of a distance, from the fit / µm") == ["15.77"]
    assert page.row("σ of a distance, stated / µm") == ["15.60"]
    assert page.row("χ² / dof") == ["1.02"]
    assert "lack of fit, F" not in [row[0] for row in page.rows]
    assert "segment 2 of reflector P1 dropped: 2 distance(s), fewer than 3" in page.text


def test_reflector_and_dead_path(page: Page) -> None:
    _, place, dead_path = [row for row in page.rows if row[0] == "P1"]
    assert place[1:] == ["651.235", "0.025", "−401.500", "0.047"]
    assert dead_path[1:] == ["0", "812.346", "0.034"]


def test_scatter_by_reflector(page: Page) -> None:
    first, *_ = [row for row in page.rows if row[0] == "P1"]
    assert first[1:] == ["8", "10.8", "20.0"]


def test_conventions_name_gauge_and_coverage(page: Page) -> None:
    assert "U is the expanded uncertainty (k = 2); files hold the standard uncertainty u." in page.text
    assert "Gauge of the error-map model: mean of theta1 map = 0." in page.text


def test_the_link_table_compares_both_models_with_the_truth(whole: Page) -> None:
    conventional, error_map = sample.whole().findings.models
    nominal, first, u1, en1, second, u2, en2, true = whole.row("L1 / mm")
    assert (nominal, true) == ("325.0", "324.9640")
    assert float(first) == pytest.approx(conventional.link1_mm.value, abs=6e-5)
    assert float(second) == pytest.approx(error_map.link1_mm.value, abs=6e-5)
    assert float(u1) == pytest.approx(2.0 * conventional.link1_mm.u, abs=6e-5)
    assert float(u2) == pytest.approx(2.0 * error_map.link1_mm.u, abs=6e-5)
    for text, model in ((en1, conventional), (en2, error_map)):
        expected = (model.link1_mm.value - 324.964) / model.link1_mm.u
        assert float(text.replace("−", "-")) == pytest.approx(expected, abs=6e-3)


def test_validation_table_shows_figures_ratio_and_alignment(whole: Page) -> None:
    validation = sample.validation()
    rows = [row for row in whole.rows if row[0] == "error map"]
    shown = [float(cell.replace("−", "-")) for cell in rows[0][1:]]
    comparison = validation.models[1].comparison
    assert shown[0:2] == pytest.approx(comparison.rms_um, abs=0.051)
    assert shown[2] == pytest.approx(comparison.rms_2d_um, abs=0.051)
    assert shown[3] == pytest.approx(comparison.max_um, abs=0.051)
    assert shown[4] == pytest.approx(validation.ratio, abs=0.0051)
    judged = validation.models[1].agreement
    aligned = [float(cell.replace("−", "-").removesuffix(" %")) for cell in rows[1][1:9]]
    assert aligned[0] == pytest.approx(1e3 * math.degrees(comparison.transform.rotation_rad), abs=0.0051)
    assert aligned[1] == pytest.approx(2e3 * math.degrees(judged.u_rotation_rad), abs=0.0051)
    assert aligned[2::2][:2] == pytest.approx(comparison.transform.shift_mm.tolist(), abs=6e-5)
    assert aligned[3::2][:2] == pytest.approx((2.0 * judged.u_shift_mm).tolist(), abs=6e-5)
    assert aligned[6:8] == pytest.approx([judged.expected_um, 100.0 * judged.share], abs=0.51)
    assert f"{int(validation.compared.sum())} rows compared" in whole.text
    assert f"{int((~validation.compared).sum())} left out" in whole.text
    assert "U = 17.0 µm (k = 2)" in whole.text


def test_reversal_error_uncertainty_includes_the_directions_covariance() -> None:
    mdeg = math.radians(1e-3)
    matrix = np.diag(np.full(14, 4.0 * mdeg**2))
    matrix[2, 5] = matrix[5, 2] = 3.0 * mdeg**2
    names = [str(i) for i in range(14)]
    covariance = Covariance(names=names, matrix=matrix.tolist())
    result = sample.hand_made().model_copy(update={"covariance": covariance})
    assert u_reversal_mdeg(result, 1) == pytest.approx([math.sqrt(2.0), math.sqrt(8.0), math.sqrt(8.0)])
    assert u_reversal_mdeg(result, 2) == pytest.approx([math.sqrt(8.0)] * 3)


def test_no_uncertainty_of_the_reversal_error_without_a_fitting_covariance() -> None:
    assert u_reversal_mdeg(sample.hand_made(), 1) is None
    covariance = Covariance(names=["L1"], matrix=[[1.0]])
    assert u_reversal_mdeg(sample.hand_made().model_copy(update={"covariance": covariance}), 1) is None
