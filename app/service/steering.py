"""Holding, letting go, stopping and aborting what moves, in the same way for every front end."""

from typing import Protocol

from catseye.app.engine.handle import RunHandle
from catseye.app.errors import InterruptedRunError
from catseye.app.protocol.ladder import Rung, top_text
from catseye.app.protocol.state import BEFORE_MOTION, ENDED, HELD
from catseye.app.service.errors import RefusedError


class Runs(Protocol):
    """Knows the run under way."""

    @property
    def run(self) -> RunHandle | None:
        """The run; None between runs."""
        ...


class BetweenRuns(Protocol):
    """What moves, or is about to, while no run is open. Both return whether there was anything."""

    def stop(self, reason: str) -> bool:
        """Stop the arm that is moved by hand; keep a run from beginning."""
        ...

    def abort(self, reason: str) -> bool:
        """The same; what was moved by hand has to be cleared before anything begins."""
        ...


class Steering:
    """Acts at once, on whatever moves.

    Args:
        between: moves the arm between runs; None where a run serves itself.
    """

    def __init__(self, runs: Runs, between: BetweenRuns | None = None) -> None:
        self._runs = runs
        self._between = between

    def running(self) -> RunHandle:
        """Return the run under way.

        Raises:
            RefusedError: there is none, or it has ended.
        """
        run = self._runs.run
        if run is None:
            raise RefusedError("no run is under way")
        if run.control.state in ENDED:
            raise RefusedError(top_text(run.control.state))
        return run

    def climb(self, who: str) -> Rung:
        """Take the next rung of the stop ladder; what is moved by hand, or about to begin, is stopped.

        Raises:
            RefusedError: no rung is left, or nothing moves.
        """
        if self._runs.run is None and self._between is not None:
            self.stop(who)
            return Rung.STOP
        control = self.running().control
        rung = control.climb(who)
        if rung is None:
            raise RefusedError(top_text(control.state))
        return rung

    def hold(self, who: str) -> None:
        """Hold the run at its next checkpoint; one that is held stays so.

        Raises:
            RefusedError: nothing can be held.
        """
        control = self.running().control
        if control.state in HELD:
            return
        if control.state in BEFORE_MOTION:
            raise RefusedError(
                "the devices are being connected and nothing moves: hold when it runs, or stop"
            )
        control.hold(f"{who} holds the run")

    def unhold(self, who: str) -> None:
        """Let a held run go on.

        Raises:
            RefusedError: it is not held.
        """
        control = self.running().control
        if control.state not in HELD:
            raise RefusedError(f"the run is not held, it is in state {control.state}")
        control.unhold(f"{who} lets the run go on")

    def stop(self, who: str) -> None:
        """Stop the arm now and end what moves it.

        Raises:
            RefusedError: nothing moves it.
        """
        # A run is stopped whatever state the rest is in; nothing is done by hand during one.
        if self._runs.run is not None or self._between is None:
            self.running().control.stop(f"{who} stopped the run")
        elif not self._between.stop(f"{who} stopped it"):
            raise RefusedError("no run is under way")

    def abort(self, who: str) -> None:
        """Stop the arm now; nothing begins before somebody has cleared that.

        Raises:
            RefusedError: nothing moves it.
        """
        if self._runs.run is not None or self._between is None:
            self.running().control.abort(InterruptedRunError(f"{who} aborted the run"))
        elif not self._between.abort(f"{who} aborted it"):
            raise RefusedError("no run is under way")
