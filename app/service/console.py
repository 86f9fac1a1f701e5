"""The terminal of a run's own process: questions are answered there, and the run is held and let go."""

from collections.abc import Callable

from catseye.app.service.client_registry import ClientRegistry
from catseye.app.service.errors import RefusedError
from catseye.app.service.questions import answer_of
from catseye.app.service.steering import Steering
from catseye.procedures.kit.context import Prompt

KEYS = "h hold · g go on · s stop · a abort"
SLASH = "/"
_COMMANDS = {"hold": "h", "go": "g", "stop": "s", "abort": "a", "quit": "q"}
_COMMANDS |= {letter: letter for letter in _COMMANDS.values()}


def command_of(line: str, asked: Prompt | None) -> str:
    """Return the command letter of a typed line; empty when it is none, "?" when it is not understood.

    Args:
        line: as typed.
        asked: the open question, beside which a command begins with a slash; None without one.
    """
    text = line.strip().lower()
    if text.startswith(SLASH):
        # The path of a file begins with a slash, too.
        path = asked is not None and asked.kind == "text"
        return _COMMANDS.get(text[1:], "" if path else "?")
    return "" if asked or not text else _COMMANDS.get(text, "?")


class Console:
    """Takes typed lines for the run under way."""

    def __init__(self, registry: ClientRegistry, who: str, say: Callable[[str], None]) -> None:
        self._registry = registry
        self._steering = Steering(registry)
        self._who = who
        self._say = say

    def take(self, line: str) -> None:
        """Take a typed line: the answer to the open question, or a command."""
        prompt = self._registry.broker.open
        command = command_of(line, prompt)
        try:
            if command:
                self._command(command)
            elif prompt is not None:
                text, fault = answer_of(prompt, line)
                if fault:
                    raise RefusedError(f"{fault} ({SLASH}h holds, {SLASH}s stops)")
                self._registry.broker.answer(prompt.id, text, self._who)
        except RefusedError as error:
            self._say(str(error))

    def end(self) -> None:
        """Nobody types any more; a question that is open waits for a client."""
        self._registry.lease.console = None

    def _command(self, letter: str) -> None:
        who = f"{self._who} at the terminal"
        match letter:
            case "h":
                self._steering.hold(who)
            case "g":
                self._steering.unhold(who)
            case "s":
                self._steering.stop(who)
            case "a":
                self._steering.abort(who)
            case _:
                raise RefusedError(f"type {KEYS}, each with Enter; Ctrl-C holds, stops, aborts")
