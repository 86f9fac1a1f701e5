"""What a run has found, in sentences that a screen reads back."""

from pathlib import Path

from catseye.app.results.found import found_sections
from catseye.app.results.model import Sign
from catseye.app.results.runs.documents import run_document
from catseye.app.results.said import Said, Verdicts
from catseye.app.store.reader import RunReader
from tests.unit.app.results.warm_ups import stored_warm_up
from tests.unit.app.store.fakes import TickingClock


async def test_a_run_says_what_it_found_with_its_sign(tmp_path: Path) -> None:
    reader = RunReader(await stored_warm_up(tmp_path, TickingClock(), 3.0, warm=True))
    written = run_document(reader, found_sections(reader)).model_dump_json()
    (said,) = Verdicts.model_validate_json(written).said
    assert (said.sign, said.short) == (Sign.GOOD, "warm after 40 min")
    assert said.text.startswith("Warm: ")


def test_a_document_without_sentences_says_nothing() -> None:
    assert Verdicts.model_validate_json('{"run": "r", "models": []}').said == ()
    assert Said(sign=Sign.BAD, text="no").short == ""
