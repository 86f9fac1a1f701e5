"""A screen that rehearses what is chosen on it, beside itself, and has the verdict come into an open start dialog."""

from abc import abstractmethod
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Final

from textual.timer import Timer

from catseye.app.tui.dialogs.start_dialog import Permission, StartDialog
from catseye.app.tui.rehearsing import Rehearser, Verdict, cell_stamp
from catseye.app.tui.screens.day import DayScreen
from catseye.app.tui.session import Session

if TYPE_CHECKING:
    # The first screen is painted before this is imported.
    from catseye.app.protocol.rehearsal import Rehearsal
    from catseye.app.protocol.requests import Start

_AT_ONCE_S: Final = 0.01


class RehearsingScreen(DayScreen):
    """A screen that can say what would start what is chosen."""

    def __init__(self, session: Session) -> None:
        super().__init__(session)
        self.rehearser = Rehearser(session, self._rehearsed)
        self._soon: Timer | None = None
        self._tries = 0
        self._start: tuple[StartDialog, Start] | None = None

    @abstractmethod
    def wanted(self) -> "Start | None":
        """Return what would start what is chosen; None while nobody can say."""

    @abstractmethod
    def start_text(self, request: "Start") -> str:
        """Say what would begin."""

    @abstractmethod
    def show_verdict(self) -> None:
        """Show what has become of a rehearsal."""

    @abstractmethod
    def say(self, text: str) -> None:
        """Say what is done meanwhile; nothing when it is empty."""

    @property
    def verdict(self) -> Verdict:
        """What is known of a rehearsal of what is chosen."""
        request = self.wanted()
        return Verdict() if request is None else self.rehearser.verdict(request)

    def rehearse_soon(self) -> None:
        """Rehearse what is chosen, once nothing else has been chosen for some time."""
        self._tries = 0
        self._in_s(self.session.rehearse_after_s)

    def rehearse(self) -> None:
        """Rehearse what is chosen now; what is under way is ended."""
        request = self.wanted()
        if request is not None:
            work = self.rehearser.rehearse(request)
            self.run_worker(work, group="rehearsal", exclusive=True, exit_on_error=False)

    def show_start(self, request: "Start", title: str, cell: str) -> None:
        """Show what would begin; F8 there begins it.

        Args:
            cell: name that is typed before a real arm moves.
        """
        dialog = StartDialog(
            title,
            self.start_text(request),
            cell,
            simulated=self.session.link.engine.bench_simulated,
            changed=self.start_changed(request),
        )
        self.follow(dialog, request)
        self.app.push_screen(dialog, partial(self._begin, request))

    def _begin(self, request: "Start", permission: Permission | None) -> None:
        self.follow(None, request)
        if permission is None:
            return
        verdict = self.rehearser.verdict(request)
        self.workers.cancel_group(self, "rehearsal")
        self.say(f"{request.procedure} is being planned …")
        order = self.catseye.order(
            request.model_copy(update={"arm": permission.arm}),
            f"{request.procedure} does not begin",
            control=True,
            then=partial(self._begun, None if verdict.stale or request.walk else verdict.rehearsal),
        )
        # Whether it has begun or was refused, no run is being planned any more.
        order.add_done_callback(lambda _: self.say("") if self.is_attached else None)

    def _begun(self, rehearsal: "Rehearsal | None") -> None:
        """Show the run, with what was rehearsed of it."""
        self.session.begun = rehearsal
        self.catseye.action_go("run")

    def follow(self, dialog: StartDialog | None, request: "Start") -> None:
        """Have what becomes of the rehearsal come into a dialog; None: into none any more."""
        self._start = None if dialog is None else (dialog, request)
        if dialog is not None and self.session.rehearse_after_s is not None:
            self._in_s(_AT_ONCE_S)

    def start_changed(self, request: "Start") -> Callable[[], str]:
        """Return what says why what was read of a start does not hold any more; empty as long as it does."""
        before = cell_stamp(request.cell)

        def changed() -> str:
            robot, cell = self.session.link.engine.robot, self.session.cell
            if cell is None or str(cell.absolute()) != request.cell:
                return "the cell has changed since this was shown"
            if cell_stamp(request.cell) != before:
                return "the cell file has changed since this was shown"
            return f"the controller is in alarm {robot.alarm_number}" if robot and robot.alarm_number else ""

        return changed

    def _in_s(self, after_s: float | None) -> None:
        if self._soon is not None:
            self._soon.stop()
        if after_s is not None:
            self._soon = self.set_timer(after_s, self._rehearse_if_lacking)

    def _rehearse_if_lacking(self) -> None:
        """Rehearse where that is possible and not done; what measures is not kept from the processor."""
        if self.session.link.engine.running:
            return
        request = self.wanted()
        if request is None:
            # Fields may be on their way; a mistake in one of them stays.
            self._tries += 1
            self._in_s(self.session.rehearse_after_s if self._tries < _MOST_TRIES else None)
        elif self.rehearser.lacks(request):
            self.rehearse()

    def _rehearsed(self) -> None:
        if not self.is_attached:
            return
        self.show_verdict()
        if self._start is not None:
            dialog, request = self._start
            dialog.show_text(self.start_text(request))


_MOST_TRIES: Final = 5
