"""A store that writes before anything else goes on, for tests that count the seconds of the manual clock."""

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any

import pytest

from catseye.app.store import writer


class AtOnce(ThreadPoolExecutor):
    """Carries every job out in the thread that submits it."""

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> "Future[Any]":
        """Return a future that is done."""
        future: Future[Any] = Future()
        try:
            future.set_result(fn(*args, **kwargs))
        except BaseException as error:  # noqa: BLE001  # the future carries it, as that of a thread does
            future.set_exception(error)
        return future


@pytest.fixture
def written_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Keep the manual clock: whoever sleeps in short steps would move it on while a thread writes."""
    monkeypatch.setattr(writer, "ThreadPoolExecutor", AtOnce)
