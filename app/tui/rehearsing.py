"""Rehearsals beside the screen: what was found, of which start, and whether that still holds."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Final, Literal

from catseye.app.results.readiness.need import Need
from catseye.app.results.rehearsal import brief_text
from catseye.app.service.command_process import Work
from catseye.app.tui.session import Session

if TYPE_CHECKING:
    # The first screen is painted before these are imported.
    from catseye.app.protocol.rehearsal import Rehearsal
    from catseye.app.protocol.requests import Start

State = Literal["none", "under way", "found", "refused", "ended"]

UNDER_WAY: Final = "under way; its verdict will appear here"
NONE: Final = "none yet: Ctrl-R rehearses"


@dataclass(frozen=True)
class Verdict:
    """What a rehearsal came to.

    Attributes:
        state: how far it is. Ended: by somebody, before it was complete.
        rehearsal: what it found.
        fault: why it was refused.
        stale: what has changed since; empty while it holds.
    """

    state: State = "none"
    rehearsal: "Rehearsal | None" = None
    fault: str = ""
    stale: str = ""

    @property
    def need(self) -> Need:
        """The verdict as one of the needs of the procedure."""
        match self.state:
            case "found" if self.rehearsal is not None:
                warned = self.rehearsal.warnings
                more = f"; {warned[0]}" if warned else ""
                text = f"{self.stale}{brief_text(self.rehearsal)}{more}"
                return Need("rehearsal", "advised" if warned or self.stale else "met", text)
            case "refused":
                return Need("rehearsal", "missing", f"{self.stale}{self.fault}")
            case "under way":
                return Need("rehearsal", "advised", UNDER_WAY)
        return Need("rehearsal", "advised", NONE)


@dataclass(frozen=True)
class _Subject:
    """What is rehearsed; another one leads to another verdict.

    Attributes:
        request: would start it, whoever permits it and however fast the clock is.
        cell: when the cell file was written, and its size; None where it cannot be looked at.
    """

    request: "Start"
    cell: tuple[int, int] | None

    @classmethod
    def of(cls, request: "Start") -> "_Subject":
        return cls(request.model_copy(update={"arm": None, "walk": False}), cell_stamp(request.cell))


class Rehearser:
    """Rehearses one start after another, each in a process of its own that is ended with the task that waits for it.

    Args:
        changed: called with each new state.
    """

    def __init__(self, session: Session, changed: Callable[[], None]) -> None:
        self._session = session
        self._changed = changed
        self._subject: _Subject | None = None
        self._verdict = Verdict()

    def verdict(self, request: "Start") -> Verdict:
        """Return what is known of a start; what has changed since stands in it."""
        known, now = self._subject, _Subject.of(request)
        if known is None or known.request != now.request:
            return Verdict()
        if known.cell != now.cell and not self._verdict.stale:
            return replace(self._verdict, stale="STALE, the cell file has changed since: ")
        return self._verdict

    def outdate(self, why: str) -> None:
        """Mark what is known as stale.

        Args:
            why: what has changed.
        """
        if self._verdict.state in {"found", "refused"}:
            self._verdict = replace(self._verdict, stale=f"STALE, {why}: ")

    def lacks(self, request: "Start") -> bool:
        """Return whether a start should be rehearsed: that was not done, or holds no more."""
        verdict = self.verdict(request)
        return verdict.state == "none" or bool(verdict.stale)

    async def rehearse(self, request: "Start") -> None:
        """Rehearse a start; cancelling ends the process."""
        self._subject = subject = _Subject.of(request)
        self._take(subject, Verdict("under way"))
        verdict = Verdict("ended")
        try:
            words = rehearsal_words(self._session.root, request)
            verdict = await rehearsed(self._session.work, *words)
        finally:
            self._take(subject, verdict)

    def _take(self, subject: _Subject, verdict: Verdict) -> None:
        if subject is self._subject:
            self._verdict = verdict
            self._changed()


async def rehearsed(work: Work, *words: str | Path) -> Verdict:
    """Return what a command that rehearses comes to; cancelling ends the command.

    Args:
        words: of the command.
    """
    from catseye.app.protocol.rehearsal import Rehearsal

    done = await work.do(*words)
    if done.code:
        return Verdict("refused", fault=done.fault)
    try:
        return Verdict("found", Rehearsal.model_validate_json(done.out))
    except ValueError:
        return Verdict("refused", fault="the output of the rehearsal cannot be read")


def rehearsal_words(root: Path, request: "Start") -> list[str]:
    """Return the words of the command that rehearses a start.

    Args:
        root: folder of all runs.
    """
    words = ["run", request.procedure, "--cell", request.cell or "", "--runs", str(root)]
    words += ["--search", request.search, "--dry-run", "--json"]
    params = request.params if isinstance(request.params, list) else []
    return [*words, *(word for text in params for word in ("--param", text))]


def cell_stamp(cell: str | None) -> tuple[int, int] | None:
    """Return when a cell file was written, and its size; None where it cannot be looked at."""
    try:
        found = Path(cell or "").stat()
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size
