"""identify with --loss, --reject, --extend, and what its result says of its uncertainties."""

import json
import math
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from catseye.app.cli.scara.identify import identify
from catseye.app.errors import UsageError
from catseye.app.results.scara.identification_report import identification_report
from catseye.app.results.scara.result import Fit, Result, read_result
from catseye.calibration.scara.points import Points
from tests.unit.app.cli.distances import write_points
from tests.unit.app.results.scara import sample
from tests.unit.calibration.scara.diagnostics.bench import Extra, commands_on_nodes, measured
from tests.unit.calibration.scara.paper import random_truth

TRUTH = random_truth(12)
WRONG = {17: 0.3, 800: -0.2}
"""Rows, from 0, with gross errors, mm."""


@cache
def points() -> Points:
    return measured(TRUTH, commands_on_nodes(), noise_mm=0.01, sigma_mm=0.01, seed=3)


def wrong_points() -> Points:
    displacement = points().displacement_mm.copy()
    for row, error in WRONG.items():
        displacement[row] += error
    return replace(points(), displacement_mm=displacement)


def run(folder: Path, given: Points, **options: Any) -> Result:
    """Identify from distances that have no error but those that they state."""
    file = write_points(given, folder)
    identify(folder / "r.json", [], file, folder / "cell.toml", budget="none", **options)
    return read_result(folder / "r.json")


def errors_in_u(result: Result) -> list[float]:
    return [
        (one.value - true) / one.u
        for one, true in ((result.link1_mm, TRUTH.link1_mm), (result.link2_mm, TRUTH.link2_mm))
    ]


def test_reject_leaves_out_the_wrong_distances_and_names_them(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    result = run(tmp_path, wrong_points(), reject=6.0)
    assert result.fit.n_points == len(points()) - 2
    first, second = result.fit.rejected
    assert first.startswith("row 18, reflector P1, segment 0, θ1 -120°, θ2 20°, approach ++")
    assert second.startswith("row 801, reflector P3")
    # Measured minus predicted, µm: the gross error and a scatter of 10 µm.
    missed = [float(text.partition(" by ")[2].split()[0]) for text in (first, second)]
    assert missed == pytest.approx([300.0, -200.0], abs=35.0)
    assert result.fit.robust is None
    said = capsys.readouterr().err
    assert said.count("Left out: row ") == 2
    assert max(map(abs, errors_in_u(result))) < 4.0


def test_a_robust_loss_keeps_them_and_says_what_they_count(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    result = run(tmp_path, wrong_points(), loss="huber")
    assert result.fit.n_points == len(points())
    assert result.fit.rejected == []
    assert result.fit.robust is not None
    # Two wrong ones; of normal errors 0.7 % lie beyond 2.69 standard deviations.
    assert 2 <= result.fit.robust.counted_little <= 2 + 20
    assert result.fit.robust.sigma_um == pytest.approx(10.0, rel=0.1)
    said = capsys.readouterr().err
    assert "huber loss: " in said
    assert "rejected" not in said
    assert max(map(abs, errors_in_u(result))) < 4.0


@pytest.mark.parametrize("loss", ["squares", "huber", "soft-l1"])
def test_parts_of_every_uncertainty_add_up_to_it(tmp_path: Path, loss: str) -> None:
    result = run(tmp_path, wrong_points(), loss=loss)
    assert result.uncertainty is not None
    table = result.uncertainty.contributions
    assert table.contributors == [
        "sigma_mm of the points" if loss == "squares" else "scatter of the distances"
    ]
    rows = {row.result: row for row in table.rows}
    for name, link in (("L1", result.link1_mm), ("L2", result.link2_mm)):
        assert math.hypot(*rows[name].u_parts) == pytest.approx(1e3 * link.u, rel=1e-9)
        assert sum(rows[name].shares) == pytest.approx(1.0)
    intervals = {one.parameter: one for one in result.uncertainty.intervals}
    half = 0.5 * (intervals["L1"].high - intervals["L1"].low)
    assert half == pytest.approx(1.96 * result.link1_mm.u, rel=5e-3)


def test_extensions_are_identified_beside_the_maps(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    warm = measured(
        TRUTH, commands_on_nodes(), Extra(link1=lambda pose: 0.05 * pose.share), 0.01, 0.01, seed=3
    )
    result = run(tmp_path, warm, extend=["thermal", "thermal"])
    assert result.extension is not None
    one, two = result.extension
    assert (one.target, one.unit, two.target, two.unit) == ("link1", "um", "link2", "um")
    assert abs(one.value - 50.0) < 4.0 * one.u < 20.0
    assert abs(two.value) < 4.0 * two.u
    assert "ΔL1 t" in capsys.readouterr().out
    assert len(result.covariance.names if result.covariance else []) == 2 + 22 + 16 + 2


def test_uncertainty_keys_of_the_result_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run(tmp_path, points(), uncertainty="monte-carlo", draws=2000, as_json=True)
    facts = json.loads(capsys.readouterr().out)
    assert set(facts) == {
        "format",
        "result",
        "model",
        "gauge",
        "link1_mm",
        "link2_mm",
        "extension",
        "fit",
        "budget",
        "j4_orders",
    }
    document = json.loads((tmp_path / "r.json").read_text(encoding="utf-8"))
    part = document["uncertainty"]
    assert set(part) == {
        "method",
        "coverage",
        "intervals",
        "contributions",
        "correlations",
        "monte_carlo",
    }
    assert (part["method"], part["coverage"]) == ("monte-carlo", 0.95)
    names = [one["parameter"] for one in part["intervals"]]
    assert names[:2] == ["L1", "L2"]
    assert len(names) == len(set(names)) == 2 + 22 + 16 + 6 + 3
    assert all(one["low"] < one["value"] < one["high"] for one in part["intervals"])
    assert {one["unit"] for one in part["intervals"]} == {"mm", "mdeg"}
    assert set(part["monte_carlo"]) == {"draws", "seed", "damped_solutions", "validation"}
    assert (part["monte_carlo"]["draws"], part["monte_carlo"]["seed"]) == (2000, 1)
    assert [one["parameter"] for one in part["monte_carlo"]["validation"]] == names
    assert all(-1.0 <= one["coefficient"] <= 1.0 for one in part["correlations"])
    assert part["contributions"]["rows"][0]["result"] == "L1"


def test_without_draws_there_is_no_part_about_them(tmp_path: Path) -> None:
    result = run(tmp_path, points())
    assert result.uncertainty is not None
    assert (result.uncertainty.method, result.uncertainty.monte_carlo) == ("jacobian", None)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"loss": "huber", "uncertainty": "monte-carlo", "draws": 2000}, "use --reject K with"),
        ({"extend": ["j5"]}, "--extend j5: unknown"),
        ({"uncertainty": "monte-carlo", "draws": 1999}, "1999 draws are too few"),
    ],
)
def test_unsound_options_are_refused_and_nothing_is_written(
    tmp_path: Path, options: dict[str, Any], message: str
) -> None:
    with pytest.raises(UsageError, match=message):
        run(tmp_path, points(), **options)
    assert not (tmp_path / "r.json").exists()


def said_of(fit: Fit) -> str:
    report = identification_report(sample.hand_made(the_fit=fit))
    return next(one.text for one in report.statements() if "repeats of a pose" in one.text.lower())


def test_lack_of_fit_is_in_capitals() -> None:
    assert said_of(sample.fit(sample.LACK)).startswith("LACK OF FIT: repeats of a pose scatter by 9.9 µm")
    assert said_of(sample.fit(sample.LACK)).endswith("the uncertainties were widened by a factor of 2.50.")
    covered = sample.fit(sample.LACK).model_copy(update={"variance_ratio": 1.0})
    assert said_of(covered).endswith("large enough to cover it and were not widened.")


def test_the_variance_of_a_row_is_not_called_a_widening(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rng = np.random.default_rng(5)
    poses = rng.normal(0.0, 0.02, 1056 // 2)
    commands = points().commands
    key = np.unique(
        np.column_stack(
            [points().reflector, np.round(commands.theta1_rad, 6), np.round(commands.theta2_rad, 6)]
        ),
        axis=0,
        return_inverse=True,
    )[1]
    moved = replace(points(), sigma_mm=None, displacement_mm=points().displacement_mm + poses[np.ravel(key)])
    run(tmp_path, moved)
    said = capsys.readouterr().err
    assert "LACK OF FIT" in said
    assert "widened" not in said
    assert "the uncertainties follow from the fit and include it" in said
