"""Texts of a result: what speaks for and against it comes before what was left out."""

import pytest

from catseye.app.results.scara.diagnosis_document import DiagnosisDocument
from catseye.app.results.scara.result import Result
from catseye.app.tui.result_texts import fit_sentences, residual_text
from tests.unit.app.tui.stored_results import DIAGNOSIS, error_map

LOST = [f"segment {number} of reflector P2 dropped: 1 distance(s), fewer than 3" for number in range(30)]


@pytest.fixture
def result() -> Result:
    fields = error_map()
    fields["fit"]["rejected"] = LOST
    return Result.model_validate(fields)


@pytest.mark.parametrize("diagnosis", [None, DIAGNOSIS], ids=["before", "after"])
def test_what_was_left_out_stands_last(result: Result, diagnosis: DiagnosisDocument | None) -> None:
    for lines in (
        residual_text(result, diagnosis).splitlines(),
        [one.text.removesuffix(".") for one in fit_sentences(result, diagnosis)],
    ):
        assert [line.lower() for line in lines[-30:]] == [f"left out: {text}".lower() for text in LOST]
        assert not [line for line in lines[:-30] if line.lower().startswith("left out")]
        assert len(lines) > 30
