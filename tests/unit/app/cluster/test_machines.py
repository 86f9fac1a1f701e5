"""What the workers of a scheduler may do to an item while others look."""

from collections.abc import Callable, Sequence
from types import SimpleNamespace
from typing import Any

import pytest

from catseye.app.cluster import machines
from catseye.app.cluster.machines import Machines


class TakenAlong:
    """A result that a dying worker took along after its end was told; it ends once more."""

    def __init__(self) -> None:
        self._told = iter(["pending"])

    @property
    def status(self) -> str:
        return next(self._told, "finished")


class Scheduler:
    """Answers like a client of dask."""

    def map(self, function: Callable[[int], int], items: Sequence[int], **_: Any) -> list[TakenAlong]:
        self._results = [function(item) for item in items]
        return [TakenAlong() for _ in items]

    def gather(self, _: list[TakenAlong]) -> list[int]:
        return self._results

    def cancel(self, _: list[TakenAlong]) -> None:
        """There is nothing to cancel."""


def test_a_result_that_is_lost_is_waited_for_again(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(machines, "wait", lambda waiting, *_: SimpleNamespace(done=set(waiting)))
    seen: list[int] = []
    client: Any = Scheduler()
    assert Machines(client).map(abs, [-5, 4], seen.append) == [5, 4]
    assert seen == [1, 2]
