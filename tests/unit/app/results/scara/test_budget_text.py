"""Whose error budget a result stands on, and what it leaves open, is said wherever the result is shown."""

import pytest

from catseye.app.cell.scara.uncertainty import Uncertainty
from catseye.app.render.html import section_html
from catseye.app.render.labels import Labels
from catseye.app.results.model import Sign
from catseye.app.results.scara.arm_report import verdict
from catseye.app.results.scara.budget_part import BudgetPart
from catseye.app.results.scara.budget_text import budget_remarks, budget_statements
from catseye.app.results.scara.comparison import compare_results
from catseye.app.results.scara.findings import Findings
from tests.unit.app.results.scara import sample

STATED = BudgetPart(
    source="table", name="points.csv", corrected_by="program", contributor=Uncertainty().contributor
)
NONE = STATED.model_copy(update={"source": "none", "contributor": []})


def test_a_stated_budget_leaves_nothing_open() -> None:
    assert budget_remarks(STATED) == []
    (statement,) = budget_statements(STATED)
    assert (statement.sign, statement.text) == (
        Sign.NEUTRAL,
        "Error budget: that of the table points.csv, 13 contributors.",
    )


@pytest.mark.parametrize(
    ("part", "remark"),
    [
        (NONE, "the scatter of the fit counts as white noise"),
        (NONE.model_copy(update={"sigma_mm": "white"}), "sigma_mm counts as white noise"),
        (STATED.model_copy(update={"sigma_mm": "total"}), "sigma_mm holds all contributors"),
        (STATED.model_copy(update={"corrected_by": None}), "the scale is not assured"),
    ],
)
def test_what_a_budget_leaves_open_is_in_the_verdict(part: BudgetPart, remark: str) -> None:
    result = sample.hand_made().model_copy(update={"budget": part})
    said = [one.text for one in verdict(Findings([result])) if one.sign is Sign.ATTENTION]
    nodes, budget = sorted(said, key=lambda text: remark in text)
    assert remark in budget
    # The sample was measured at its nodes only.
    assert nodes.startswith("Nothing was measured between the nodes of J1 and J2")


def test_a_result_page_lists_the_budget_that_it_stands_on() -> None:
    result = sample.hand_made().model_copy(update={"budget": STATED})
    (found,) = (one for one in sample.bare(result).report.sections if one.title == "Uncertainty")
    text = section_html(found, iter(()), Labels(found.blocks))
    assert "that of the table points.csv" in text
    assert "radial error motion of J4" in text


def test_results_on_different_budgets_are_named() -> None:
    first, second = (sample.hand_made().model_copy(update={"budget": part}) for part in (STATED, NONE))
    remark = "their uncertainties stand on different error budgets"
    assert remark in compare_results(first, second).remarks
    assert remark not in compare_results(first, first).remarks


def test_beside_a_white_sigma_only_what_is_shared_counts() -> None:
    white = STATED.model_copy(update={"sigma_mm": "white"}).budget
    whole = STATED.budget
    assert white is not None
    assert whole is not None
    assert white.contributors == whole.systematic
    assert whole.white != ()
    assert NONE.budget is None
