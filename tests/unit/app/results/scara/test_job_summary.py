"""Summary of a whole job: what it says beside its tables."""

from dataclasses import replace

import numpy as np

from catseye.app.render.text import report_text
from catseye.app.results.scara.job_summary import job_summary
from catseye.app.results.scara.truth import TruthComparison
from tests.unit.app.results.scara import sample


def test_the_summary_says_why_rows_are_left_out() -> None:
    truth = TruthComparison(["L1"], ["mm"], np.array([325.01]), np.array([325.0]), np.array([0.01]))
    whole = sample.validation()
    compared = whole.compared.copy()
    compared[np.flatnonzero(compared)[:2]] = False
    text = report_text(job_summary(truth, sample.fit(), replace(whole, compared=compared)))
    count = int((~compared).sum())
    assert f"{count} rows of the path are left out (beyond the nodes, or a joint has just reversed)." in text
