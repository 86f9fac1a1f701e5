"""The store against a dictionary, with deaths and reopenings in between."""

import asyncio
import shutil
import tempfile
from dataclasses import asdict
from pathlib import Path

from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, precondition, rule

from catseye.app.store.reader import RunReader
from catseye.app.store.run_store import RunStore
from catseye.app.store.verify import verify
from catseye.procedures.kit.records import Row
from tests.unit.app.store.fakes import RECORDS, SEARCH_ROW, TickingClock

STEP_IDS = st.sampled_from([f"s{number}" for number in range(8)])


class StoreMachine(RuleBasedStateMachine):
    """Does the same to the store and to a dictionary."""

    def __init__(self) -> None:
        super().__init__()
        self.root = Path(tempfile.mkdtemp())
        self.loop = asyncio.Runner()
        self.clock = TickingClock()
        create = RunStore.create(self.root, "model", {}, self.clock, records=RECORDS, reserve_bytes=0)
        self.store = self.loop.run(create)
        self.steps: dict[str, tuple[int, int]] = {}
        self.dropped: dict[str, int] = {}
        self.kinds = ["run-opened"]
        self.answers: list[str] = []

    @rule(step_id=STEP_IDS, rows=st.integers(0, 4))
    def finish_step(self, step_id: str, rows: int) -> None:
        if self.store.stored_result(step_id) is None:
            attempt = self.store.next_attempt(step_id)
            assert attempt == 1 + self.dropped.get(step_id, 0)
            data: list[tuple[str, Row]] = [("search", SEARCH_ROW)] * rows
            self.loop.run(self.store.append_step(step_id, attempt, "title", {"rows": rows}, data))
            self.steps[step_id] = (attempt, rows)

    @rule(step_id=STEP_IDS)
    def drop_step(self, step_id: str) -> None:
        attempt = self.store.next_attempt(step_id)
        if step_id not in self.steps:
            self.loop.run(self.store.drop_step(step_id, attempt, {}))
            self.dropped[step_id] = attempt
            self.kinds.append("step-dropped")

    @rule(kind=st.sampled_from(["note", "warning"]))
    def happen(self, kind: str) -> None:
        self.loop.run(self.store.event(kind))
        self.kinds.append(kind)

    @rule(answer=st.text(st.characters(codec="utf-8"), max_size=5))
    def answer(self, answer: str) -> None:
        self.loop.run(self.store.prompt("id", "text", "?", "2026-01-02T00:00:00+00:00", answer, "Ada"))
        self.answers.append(answer)

    @rule()
    def die(self) -> None:
        """Go on from what the disk holds at this instant, as after a kill."""
        copy = self.root / f"{len(self.kinds)}-{self.clock.ticks}"
        copy.mkdir()
        for path in self.store.path.iterdir():
            if not path.name.endswith("-shm"):
                shutil.copy(path, copy / path.name)
        self.loop.run(self.store.abandon())
        assert RunReader(copy).status == "died"
        self._reopen(copy)

    @precondition(lambda self: len(self.kinds) > 3)
    @rule(status=st.sampled_from(["stopped", "failed", "aborted"]))
    def end_early(self, status: str) -> None:
        self.loop.run(self.store.finish(status, 3))
        self.kinds.append("run-ended")
        assert verify(self.store.path).ok
        assert RunReader(self.store.path).status == status
        self._reopen(self.store.path)

    def _reopen(self, path: Path) -> None:
        self.store = self.loop.run(RunStore.reopen(path, self.clock, records=RECORDS, reserve_bytes=0))
        self.kinds.append("run-reopened")

    @invariant()
    def the_store_holds_what_the_dictionary_holds(self) -> None:
        reader = RunReader(self.store.path)
        steps = [asdict(step) for step in reader.steps()]
        assert {step["step_id"]: (step["attempt"], step["row_count"]) for step in steps} == self.steps
        assert len(reader.rows("search")) == sum(rows for _, rows in self.steps.values())
        assert [event.kind for event in reader.events()] == self.kinds
        assert [prompt["answer"] for prompt in reader.prompts()] == self.answers
        assert verify(self.store.path).problems == ()

    def teardown(self) -> None:
        self.loop.run(self.store.abandon())
        self.loop.close()
        shutil.rmtree(self.root)


TestStoreMachine = StoreMachine.TestCase
TestStoreMachine.settings = settings(max_examples=15, stateful_step_count=12)
