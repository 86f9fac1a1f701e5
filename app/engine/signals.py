"""Signals of the operating system as requests of the stop ladder."""

import asyncio
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager

from catseye.app.engine.control import SIGNALS

SignalInstaller = Callable[[Callable[[int], None]], AbstractContextManager[None]]
"""Delivers signals to a function, in the event loop, while the context manager is entered."""


@contextmanager
def loop_signals(on_signal: Callable[[int], None]) -> Iterator[None]:
    """Deliver the signals of this process; Ctrl-C raises no KeyboardInterrupt meanwhile."""
    loop = asyncio.get_running_loop()
    for number in SIGNALS:
        loop.add_signal_handler(number, on_signal, int(number))
    try:
        yield
    finally:
        for number in SIGNALS:
            loop.remove_signal_handler(number)
