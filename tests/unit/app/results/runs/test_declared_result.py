"""The result of a run in the words of its procedure."""

from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any, cast

import pytest

from catseye.app.results.model import Section, Statement
from catseye.app.results.runs import declared_result, event_text
from catseye.app.store.reader import RunReader, StoredEvent
from catseye.procedures.kit.event_text import EventText

TEXTS = {
    "read-back": EventText(lambda data: f"deviation {data['mean_deg']:.3f}°", shown=True),
    "looked": EventText(lambda _data: "looked around"),
}


@dataclass
class Run:
    """A stored run of a procedure of somebody else."""

    happened: list[tuple[str, dict[str, Any]]]
    meta: dict[str, str] = field(default_factory=lambda: {"procedure": "norra-readback"})

    def events(self) -> list[StoredEvent]:
        return [StoredEvent(number, "", kind, data) for number, (kind, data) in enumerate(self.happened)]


@pytest.fixture
def declared(monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
    event_text.texts_of.cache_clear()
    made = SimpleNamespace(event_texts=TEXTS, analyses=())
    for module in (declared_result, event_text):
        monkeypatch.setattr(module, "declared_by", lambda _name: made)
    return made


def sections(*happened: tuple[str, dict[str, Any]]) -> list[Section]:
    found = declared_result.declared_sections(cast("RunReader", Run(list(happened))))
    event_text.texts_of.cache_clear()
    return found


@pytest.mark.usefixtures("declared")
def test_the_last_word_of_each_shown_event_is_the_result() -> None:
    (found,) = sections(("read-back", {"mean_deg": 0.1}), ("looked", {}), ("read-back", {"mean_deg": 0.2}))
    assert [block.text for block in found.blocks if isinstance(block, Statement)] == ["deviation 0.200°"]


@pytest.mark.usefixtures("declared")
def test_a_run_that_ended_before_has_no_result() -> None:
    assert sections(("looked", {})) == []


def test_a_run_that_a_command_works_on_waits_for_it(declared: SimpleNamespace) -> None:
    declared.analyses = ("identify",)
    assert sections(("read-back", {"mean_deg": 0.1})) == []


def test_a_procedure_that_is_not_installed_says_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(declared_result, "declared_by", lambda _name: None)
    assert sections(("read-back", {"mean_deg": 0.1})) == []
