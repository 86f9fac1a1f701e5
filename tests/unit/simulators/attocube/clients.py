"""A client of the emulated IDS that speaks JSON-RPC as the maker's API does."""

import json
from typing import Any

from catseye.simulators.ports.session import Pending, Session
from catseye.simulators.world.timed_bench import TimedBench


def send(session: Session, method: str, *params: object) -> bytes | Pending:
    """Send one request, return what the session makes of it."""
    request: dict[str, object] = {"jsonrpc": "2.0", "method": method, "api": 2, "id": 5}
    if params:
        request["params"] = list(params)
    session.feed(json.dumps(request).encode())
    answer = session.answer()
    assert answer is not None
    return answer


def read(answer: bytes | Pending) -> Any:
    """Return the result of an answer that is there, or the error of JSON-RPC."""
    assert isinstance(answer, bytes)
    said = json.loads(answer)
    assert said["id"] == 5
    return said.get("result", said.get("error"))


def ask(session: Session, method: str, *params: object) -> Any:
    """Ask what is answered at once."""
    return read(send(session, method, *params))


def wait(bench: TimedBench, answer: bytes | Pending) -> Any:
    """Let bench time pass until the answer is due; return its result."""
    assert isinstance(answer, Pending)
    while (due_s := answer.due()) is not None:
        bench.advance(due_s - bench.time_s)
    return read(answer.reply())
