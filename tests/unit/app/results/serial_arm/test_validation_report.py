"""What is said first about a validated arm."""

import numpy as np
import pytest

from catseye.app.render.page import page_html
from catseye.app.results.model import Statement
from catseye.app.results.origin import origin_now
from catseye.app.results.serial_arm.validation import ArmValidation, Errors
from catseye.app.results.serial_arm.validation_report import arm_validation_report


@pytest.mark.parametrize(
    ("inside", "signs"),
    [
        (95.0, ["good", "neutral"]),
        (40.0, ["attention", "attention"]),
        # The table states no u_mm: nobody judges it.
        (None, ["neutral", "neutral"]),
    ],
)
def test_only_errors_that_were_expected_are_good(inside: float | None, signs: list[str]) -> None:
    errors = Errors(np.array([0.1, 0.2]))
    found = ArmValidation(errors, None, inside, ("1", "2"), ("nest1", "nest1"), of_distances=False)
    blocks = arm_validation_report(found, "poses.csv", origin_now()).blocks(brief=True)
    assert [block.sign for block in blocks if isinstance(block, Statement)] == signs


def test_the_verdict_links_to_what_shows_it() -> None:
    errors = Errors(np.array([0.1, 0.2]))
    found = ArmValidation(errors, None, 95.0, ("1", "2"), ("nest1", "nest1"), of_distances=False)
    page = page_html(arm_validation_report(found, "poses.csv", origin_now()))
    for anchor in ("table-validation", "figure-validation-errors"):
        assert f'href="#{anchor}"' in page
        assert f'id="{anchor}"' in page
