"""Fixtures of every test: nothing may be left behind."""

import asyncio
import gc
import os
import threading
from collections.abc import AsyncIterator, Iterator
from pathlib import Path

import pytest


def _open_files() -> dict[str, str]:
    """Return the sockets and regular files that this process holds open, by descriptor."""
    links: dict[str, str] = {}
    for entry in Path("/proc/self/fd").iterdir():
        try:
            target = os.readlink(entry)
        except OSError:
            continue
        # matplotlib keeps each font open that it has used once, for as long as the process lives.
        if target.startswith("/dev/") or "/mpl-data/fonts/" in target:
            continue
        if target.startswith(("socket:", "/")):
            links[entry.name] = target
    return links


@pytest.fixture(scope="session", autouse=True)
def imported_modules_stay() -> None:
    """Take what importing has made out of the garbage collector's rounds, of which every test pays one."""
    gc.collect()
    gc.freeze()


@pytest.fixture(autouse=True)
def nothing_left_behind() -> Iterator[None]:
    """Fail a test that leaves a thread, a socket or an open file."""
    threads_before = set(threading.enumerate())
    files_before = _open_files()
    yield
    gc.collect()
    threads = [t.name for t in set(threading.enumerate()) - threads_before if t.is_alive()]
    files = [target for fd, target in _open_files().items() if files_before.get(fd) != target]
    assert not threads, f"threads left running: {threads}"
    assert not files, f"files or sockets left open: {files}"
    # What lives on by now does so for the session, modules and caches: the next round need not walk through it.
    gc.freeze()


@pytest.fixture(autouse=True)
async def no_task_left_behind(
    nothing_left_behind: None,  # noqa: ARG001  # looks last, when the loop with its threads is closed
    request: pytest.FixtureRequest,
) -> AsyncIterator[None]:
    """Fail a coroutine test that leaves a task."""
    yield
    tasks = [task for task in asyncio.all_tasks() if task is not asyncio.current_task()]
    names = [repr(task.get_coro()) for task in tasks]
    assert not names, f"tasks left running after {request.node.name}: {names}"
