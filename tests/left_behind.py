"""What a test must not leave behind, in whichever process it runs."""

import gc
import os
import sys
import threading
import warnings
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

_WAY_OUT_S = 1.0


@contextmanager
def nothing_left() -> Iterator[None]:
    """Fail where a thread, a socket or an open file is left."""
    threads_before = set(threading.enumerate())
    files_before = _open_files()
    yield
    gc.collect()
    threads = [thread.name for thread in set(threading.enumerate()) - threads_before if not _ends(thread)]
    files = [target for fd, target in _open_files().items() if files_before.get(fd) != target]
    assert not threads, f"threads left running: {threads}"
    assert not files, f"files or sockets left open: {files}"
    # What lives on by now does so for the session, modules and caches: the next round need not walk through it.
    gc.freeze()


@contextmanager
def warnings_fail() -> Iterator[None]:
    """Fail on warnings and on errors that nobody catches, as pytest does in its own process."""
    unseen: list[str] = []
    with warnings.catch_warnings(), pytest.MonkeyPatch.context() as patch:
        warnings.simplefilter("error")
        for module, hook in ((sys, "unraisablehook"), (threading, "excepthook")):
            patch.setattr(module, hook, lambda seen: unseen.append(repr(seen.exc_value)))
        yield
        gc.collect()
    assert not unseen, f"errors that nobody caught: {unseen}"


def _open_files() -> dict[str, str]:
    """Return the sockets and regular files that this process holds open, by descriptor."""
    links: dict[str, str] = {}
    for descriptor in os.listdir("/proc/self/fd"):
        try:
            target = os.readlink(f"/proc/self/fd/{descriptor}")
        except OSError:
            continue
        # matplotlib keeps each font open that it has used once, for as long as the process lives.
        if target.startswith("/dev/") or "/mpl-data/fonts/" in target:
            continue
        if target.startswith(("socket:", "/")):
            links[descriptor] = target
    return links


def _ends(thread: threading.Thread) -> bool:
    """Return whether a thread has done its work: one that has delivered its result may still be on its way out."""
    thread.join(_WAY_OUT_S)
    return not thread.is_alive()
