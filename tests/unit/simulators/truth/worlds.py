"""Benches with the errors that real ones have, and clients without a socket."""

from collections.abc import Callable, Sequence

import numpy as np
from scipy.stats import chi2

from catseye.simulators.config import EmulatedDevice, EmulationConfig, ErrorBudget, Option
from catseye.simulators.context import EmulationContext
from catseye.simulators.emulated_bench import EmulatedBench
from catseye.simulators.emulator import sessions_of
from catseye.simulators.ports.session import Pending, Session
from tests.unit.simulators.benches import P1, P2, P3, aimed, go

BUDGET = ErrorBudget()
_RARE = 1e-4
"""How often a statement about normal errors may be wrong; seeds are fixed, so a test that holds goes on holding."""


def world(seed: int = 4) -> EmulationContext:
    """Return the bench of a SCARA whose beam returns from P2, with all errors of the default budget."""
    config = EmulationConfig(reflectors=(P1, P2, P3), acceptance_mm=30.0, seed=seed)
    context = EmulatedBench(config).context
    go(context.beam_bench, aimed(20.0, 30.0))
    context.bench.advance(5.0)
    assert context.beam_bench.true_state().reflector == "P2"
    return context


def session_of(
    context: EmulationContext, protocol: str, name: str = "instrument", **options: Option
) -> Session:
    """Return a session of a protocol as a client meets it."""
    return sessions_of(context, EmulatedDevice(name, protocol, options=options), lambda _text: None)()


def said(context: EmulationContext, session: Session, data: bytes) -> bytes:
    """Send bytes; let bench time pass until all of them are answered, and return the answers."""
    session.feed(data)
    answers = b""
    while (answer := session.answer()) is not None:
        if isinstance(answer, Pending):
            while (due_s := answer.due()) is not None:
                context.bench.advance_to(due_s)
            answer = answer.reply()
        answers += answer
    return answers


def heard(context: EmulationContext, session: Session, duration_s: float) -> bytes:
    """Let bench time pass; return what comes unasked meanwhile."""
    until_s = context.bench.time_s + duration_s
    streamed = b""
    while (due_s := session.next_output_s()) is not None and due_s <= until_s:
        context.bench.advance_to(due_s)
        streamed += session.output()
    context.bench.advance_to(until_s)
    return streamed + session.output()


def assert_unsure(errors: Sequence[float], u: float, at_most: float | None = None) -> None:
    """Assert that differences from the truth are as large as a standard uncertainty makes them.

    Args:
        errors: independent differences, or what several seeds give.
        u: the standard uncertainty that the instrument has at least.
        at_most: the one that it has at most; None: u.
    """
    count = len(errors)
    rms = float(np.sqrt(np.mean(np.square(errors))))
    low, high = np.sqrt(chi2.ppf((_RARE, 1.0 - _RARE), count) / count)
    assert u * low < rms < (at_most or u) * high, (rms, u, errors)


def repeated(read: Callable[[], float], count: int = 30) -> list[float]:
    """Return what a question is answered again and again, less the mean: errors of a repetition."""
    values = np.array([read() for _ in range(count)])
    return [float(off) for off in (values - values.mean()) * np.sqrt(count / (count - 1.0))]
