"""Sentences of the verdict say what the figures say."""

from dataclasses import replace

import pytest

from catseye.app.results.scara.arm_report import verdict
from catseye.app.results.scara.fit_text import fit_statement
from catseye.app.results.scara.result import Fit, LackOfFitPart, RobustPart
from catseye.app.results.scara.truth_tables import TruthMap, normalised_errors, truth_statement
from catseye.app.results.scara.validation import validate_on_path
from tests.unit.app.results.scara import sample


def sentence(fit: Fit) -> tuple[str, str]:
    statement = fit_statement(fit, "error map")
    return statement.sign, statement.text


def test_a_fit_that_agrees() -> None:
    assert sentence(sample.fit()) == (
        "good",
        "The fit of the error map agrees with the stated 15.6 µm (χ²/dof = 1.02, p = 0.30).",
    )


def test_lack_of_fit_that_nothing_stated_explains() -> None:
    assert sentence(sample.fit(sample.LACK)) == (
        "bad",
        "LACK OF FIT: repeats of a pose scatter by 9.9 µm, but the error map misses them by 21.3 µm "
        "systematically, beyond what is stated (F = 17.8, p < 0.001); the uncertainties were widened by a factor of "
        "2.50.",
    )


def test_what_an_older_result_explains_is_no_lack_of_fit() -> None:
    older = sample.LACK.model_dump() | {"explained": True, "expected_ratio": 16.2, "probability_stated": 0.41}
    kind, text = sentence(sample.fit(LackOfFitPart.model_validate(older)))
    assert kind == "good"
    assert "agrees with the stated 15.6 µm" in text
    assert "LACK OF FIT" not in text


def test_a_fit_that_scatters_more_than_stated() -> None:
    kind, text = sentence(sample.fit(chi2=(4.0, 1e-5)).model_copy(update={"variance_ratio": 4.0}))
    assert kind == "bad"
    assert "scatters by 15.8 µm, more than the stated 7.9 µm (χ²/dof = 4.00, p < 0.001)" in text
    assert "widened by a factor of 2.00" in text


def test_a_fit_that_scatters_less_than_stated() -> None:
    kind, text = sentence(sample.fit(chi2=(0.25, 1.0)))
    assert kind == "neutral"
    assert "less than the stated 31.5 µm" in text


def test_a_robust_fit_says_what_stands_for_the_stated_uncertainties() -> None:
    robust = RobustPart(loss="huber", sigma_um=10.3, half=2.69, counted_little=4)
    kind, text = sentence(sample.fit(chi2=None).model_copy(update={"robust": robust}))
    assert kind == "neutral"
    assert text == (
        "The error map was identified with huber loss: 4 of 1056 distances count less than half (beyond 2.7 robust "
        "standard deviations of 10.3 µm); the scatter that the distances show stands for the stated white "
        "contributors."
    )


def test_a_fit_without_stated_uncertainties() -> None:
    kind, text = sentence(sample.fit(chi2=None))
    assert kind == "neutral"
    assert text == (
        "No uncertainty was stated for the distances; those of the error map follow from the scatter of its fit, "
        "15.8 µm a distance."
    )
    lack = sentence(sample.fit(sample.LACK, chi2=None))[1]
    assert lack.endswith("the uncertainties follow from the fit and include it.")


def test_null_directions_are_named() -> None:
    fit = sample.fit().model_copy(update={"null_directions": [["Δθ1(60°, +)"], ["L1", "L2"]]})
    texts = [one.text for one in verdict(sample.bare(sample.hand_made(the_fit=fit)).findings)]
    assert "Not observable, and therefore without numbers: Δθ1(60°, +); L1, L2." in texts


@pytest.mark.parametrize(
    ("probability", "sign", "end"),
    [
        (0.3, "good", ", p = 0.30)."),
        (1e-4, "attention", ", p < 0.001: more than the uncertainties explain)."),
    ],
)
def test_path_verdict_gives_ratio_rows_and_test(probability: float, sign: str, end: str) -> None:
    validation = sample.validation()
    last = validation.models[-1]
    judged = replace(last, agreement=replace(last.agreement, probability=probability))
    given = replace(validation, models=(*validation.models[:-1], judged))
    statement = verdict(replace(sample.whole().findings, validation=given))[2]
    assert statement.sign == sign
    assert statement.text.startswith("On the path X = 200 mm, Y = −500 … 500 mm the error map leaves ")
    assert f"ratio {validation.ratio:.2f} ({validation.compared.sum()} of 82 rows compared" in statement.text
    assert statement.text.endswith(end)


@pytest.mark.parametrize(("probability", "sign"), [(0.3, "neutral"), (1e-4, "attention")])
def test_path_verdict_of_one_model_has_no_ratio(probability: float, sign: str) -> None:
    alone = validate_on_path(sample.path(), [sample.measurement()[1][1].arm], (325.0, 225.0))
    (model,) = alone.models
    judged = replace(model, agreement=replace(model.agreement, probability=probability))
    given = replace(alone, models=(judged,))
    statement = verdict(replace(sample.whole().findings, validation=given))[2]
    assert statement.sign == sign
    assert "ratio" not in statement.text


def test_only_truth_within_the_uncertainties_is_good() -> None:
    result, truth = sample.results()[1], sample.truth_tables()
    assert truth_statement(result, truth).sign == "good"
    wrong = replace(truth, link1_mm=325.2)
    statement = truth_statement(result, wrong)
    assert statement.text.endswith("at L1.")
    shifted = [value + 10.0 for value in truth.theta1_map.positive_mdeg]
    far = replace(truth, theta1_map=replace(truth.theta1_map, positive_mdeg=shifted))
    assert truth_statement(result, far).sign == "bad"


def test_normalised_errors_leave_out_nodes_beyond_the_truth() -> None:
    result, truth = sample.hand_made(), sample.truth_tables()
    short = TruthMap([-10.0, 10.0], [0.0, 0.0], [0.0, 0.0])
    errors = {
        e.name: e.value for e in normalised_errors(result, replace(truth, theta1_map=short, theta2_map=short))
    }
    assert set(errors) == {
        "L1",
        "L2",
        "P1 x",
        "P1 y",
        *(f"Δθ{joint}(0°, {sign})" for joint in (1, 2) for sign in "+−"),
    }
    assert errors["Δθ1(0°, +)"] == pytest.approx(3.456 / 0.62)
    assert errors["L1"] == pytest.approx((324.964123 - 324.964) / 0.00234)
