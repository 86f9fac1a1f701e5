"""A run as far as the engine's events and its record have shown it."""

import math
from collections import deque
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final, Literal

from catseye.app.protocol.state import ENDED, ControlState
from catseye.app.tui.run_pace import RunPace
from catseye.drivers.roles.text import harmless_lines

if TYPE_CHECKING:
    # The first screen is painted before these are imported.
    from catseye.app.protocol.bench import BeamStatus
    from catseye.app.protocol.events import AnyEvent
    from catseye.app.protocol.message import Event
    from catseye.app.protocol.rehearsal import Rehearsal, RehearsedStep
    from catseye.app.protocol.run_events import (
        FirstMotionShown,
        Happened,
        LiveData,
        LiveStepData,
        PromptAsked,
        RunEnded,
    )
    from catseye.app.protocol.snapshot import Snapshot

LOG_LINES: Final = 2000
VALUES_KEPT: Final = 600

NOT_LOGGED: Final = frozenset({"map-known", "devices", "asked"})
"""Kinds of events that are shown elsewhere than in the log."""


@dataclass(frozen=True)
class LogLine:
    """A line of the log.

    Attributes:
        t: ISO 8601 UTC time.
        level: info, warning or error.
        text: what happened.
    """

    t: str
    level: str
    text: str

    def __post_init__(self) -> None:
        """Show as an escape what would command the terminal: answers of others, records of older programs."""
        object.__setattr__(self, "text", harmless_lines(self.text))


@dataclass
class Step:
    """A step of the procedure.

    Attributes:
        id: of the step.
        title: one line.
        status: whether it is under way.
        stored: its result was there from before an interruption.
    """

    id: str
    title: str
    status: Literal["current", "done"]
    stored: bool = False


@dataclass(frozen=True)
class SoFar:
    """What the record of a run holds that began before this client came.

    Attributes:
        steps: id and title of the steps that are done, in order.
        points: how many rows of what is measured.
        log: what happened, oldest first.
        command: words of `catseye` that rehearse the same run; empty where they are not known.
        speed: bench seconds in one real second; None where it is not known.
    """

    steps: list[tuple[str, str]]
    points: int
    log: list[LogLine]
    command: tuple[str, ...] = ()
    speed: float | None = None


@dataclass
class LiveValue:
    """A value that is watched while it changes.

    Attributes:
        data: the value now, with its acceptance band.
        at_s: when it came, monotonic s.
        history: all of its values, oldest first, this one included.
        peak: the largest since the question or step began.
        was_out: it was outside of its band since then.
        fresh: it came since then.
    """

    data: "LiveData"
    at_s: float
    history: "deque[LiveData]" = field(default_factory=lambda: deque(maxlen=VALUES_KEPT))
    peak: float = -math.inf
    was_out: bool = False
    fresh: bool = True

    def __post_init__(self) -> None:
        """Count the first value."""
        self.peak = max(self.peak, self.data.value)
        self.was_out = self.was_out or not self.data.accepted

    def after(self, known: "LiveValue | None") -> "LiveValue":
        """Return it as the successor of an older one."""
        if known is not None:
            self.history = known.history
            if known.fresh:
                self.peak, self.was_out = max(self.peak, known.peak), self.was_out or known.was_out
        self.history.append(self.data)
        return self


@dataclass
class RunState:
    """One run.

    Attributes:
        name: of the run.
        procedure: its name.
        title: one line for people.
        since_s: when this client first heard of it, monotonic s.
        path: of its directory; empty until it is known.
        simulated: None until the devices are known.
        active: it has not ended.
        state: where it stands.
        reason: why it is in that state.
        steps: that were begun, oldest first.
        pace: how far it is.
        live: values by name, the newest last.
        beam: signal of the beam while hands are at work, as the bench has it; None where there is none.
        staircase: steps of the series under way that this client has seen, oldest first.
        prompt: the open question.
        prompt_at_s: when it came.
        points_seen: how many distances, targets or lengths were measured.
        log: lines, oldest first.
        ended: the event of its end.
        recorded: its record was asked for what happened before this client came.
        command: words of `catseye` that rehearse the same run; empty until they are known.
        speed: bench seconds in one real second; None until it is known.
        rehearsal: of the whole run; None until there is one.
        seen_begin: this client saw its beginning.
        stored: ids of steps that its record held at first: before an interruption they were done.
    """

    name: str
    procedure: str
    title: str
    since_s: float
    path: str = ""
    simulated: bool | None = None
    active: bool = True
    state: ControlState = ControlState.IDLE
    reason: str = ""
    steps: dict[str, Step] = field(default_factory=dict)
    pace: RunPace = field(default_factory=RunPace)
    live: dict[str, LiveValue] = field(default_factory=dict)
    beam: LiveValue | None = None
    staircase: "list[LiveStepData]" = field(default_factory=list)
    prompt: "PromptAsked | None" = None
    prompt_at_s: float = 0.0
    points_seen: int = 0
    log: deque[LogLine] = field(default_factory=lambda: deque(maxlen=LOG_LINES))
    ended: "RunEnded | None" = None
    recorded: bool = False
    command: tuple[str, ...] = ()
    speed: float | None = None
    rehearsal: "Rehearsal | None" = None
    seen_begin: bool = False
    stored: frozenset[str] = frozenset()

    def __post_init__(self) -> None:
        """Count the time from now on."""
        self.pace.begin(self.since_s)

    @classmethod
    def of_snapshot(cls, snapshot: "Snapshot", now_s: float) -> "RunState":
        """Return a run that was under way when this client came."""
        run = cls(snapshot.run or "", snapshot.procedure or "", snapshot.title or "", now_s)
        run.path = snapshot.path or ""
        run.simulated = snapshot.simulated
        run.state, run.reason = snapshot.state, snapshot.reason or ""
        run.active = run.state not in ENDED
        run.prompt = snapshot.prompt
        run.prompt_at_s = now_s - (snapshot.prompt_open_s or 0.0)
        for event in (snapshot.step, snapshot.progress, snapshot.live):
            if event is not None:
                run.take(event, now_s)
        return run

    @property
    def steps_done(self) -> int:
        """How many steps are done."""
        return sum(step.status == "done" for step in self.steps.values())

    @property
    def current(self) -> Step | None:
        """The step under way."""
        return next((step for step in reversed(self.steps.values()) if step.status == "current"), None)

    @property
    def to_come(self) -> "list[RehearsedStep]":
        """The steps of the rehearsal that were not begun; none after the end."""
        planned = () if self.rehearsal is None or not self.active else self.rehearsal.steps
        return [step for step in planned if step.step not in self.steps]

    @property
    def watched(self) -> LiveValue | None:
        """The value that matters now: judged ones before others, and in a question none from before it."""
        newest = list(reversed(self.live.values()))
        fresh = [value for value in newest if value.fresh]
        if not fresh and self.prompt is not None:
            return self.beam if self.prompt.task is not None else None
        values = fresh or newest
        judged = (value for value in values if value.data.low is not None or value.data.high is not None)
        return next(judged, next(iter(values), None))

    @property
    def rehearsed_s(self) -> float:
        """How long it takes by its rehearsal, without what was done before it went on; 0 where nobody knows."""
        known = self.rehearsal
        if known is None:
            return 0.0
        return known.total_s - sum(step.duration_s for step in known.steps if step.step in self.stored)

    def take_rehearsal(self, rehearsal: "Rehearsal | None") -> None:
        """Take what a rehearsal of this run has found; its time stands until the engine's first word."""
        self.rehearsal = rehearsal
        if self.seen_begin and self.rehearsed_s:
            self.pace.expect(self.rehearsed_s)

    def take_record(self, so_far: SoFar) -> None:
        """Take what the record holds; what has come meanwhile stays, behind it."""
        come, self.steps = self.steps, {}
        self.stored = frozenset(step_id for step_id, _ in so_far.steps)
        for step_id, title in so_far.steps:
            self.steps[step_id] = Step(step_id, title, "done")
        for step_id, step in come.items():
            if step_id not in self.steps or step.stored:
                self.steps[step_id] = step
        self.points_seen = max(self.points_seen, so_far.points)
        first = self.log[0].t if self.log else ""
        lately = {(line.t[:19], line.text) for line in self.log}
        before = [line for line in so_far.log if not first or line.t < first]
        self.log.extendleft(line for line in reversed(before) if (line.t[:19], line.text) not in lately)
        self.recorded, self.command, self.speed = True, so_far.command, so_far.speed

    def lost_sight(self) -> None:
        """It ended unseen."""
        self.active, self.prompt = False, None

    def take(self, event: "AnyEvent", now_s: float) -> None:
        """Take an event of this run.

        Args:
            now_s: monotonic time of its arrival, s.
        """
        from catseye.app.protocol import run_events

        match event:
            case run_events.LiveShown():
                self.take_live(event.data, now_s)
            case run_events.FirstMotionShown():
                self._happened(event, "first-motion")
            case run_events.DrivesLeft():
                self._note(event, "info", event.data.text)
            case run_events.Happened():
                self._happened(event, event.kind)
            case run_events.StateFields():
                self.state, self.reason = event.state, event.reason
                self._note(event, "info", f"{event.state}: {event.reason}" if event.reason else event.state)
            case run_events.StepStarted():
                self.begin_phase()
                # Begun anew it stands at the end again.
                self.steps.pop(event.step, None)
                self.steps[event.step] = Step(event.step, event.title, "current")
            case run_events.StepDone():
                step = self.steps.setdefault(event.step, Step(event.step, event.title, "current"))
                step.status, step.stored = "done", event.stored
            case run_events.PointMeasured():
                self.points_seen += 1
            case run_events.Progressed():
                self.pace.take(event, now_s)
            case run_events.PromptAsked():
                self.prompt, self.prompt_at_s = event, now_s
                self.begin_phase()
            case run_events.PromptAnswered():
                self.prompt = None
                self.begin_phase()
                self._note(event, "info", f"{event.id}: {event.answer} ({event.who})")
            case run_events.WarningIssued():
                if event.data.simulated:
                    self.simulated = True
                self._note(event, "warning", event.text)
            case run_events.ErrorReported():
                self._note(event, "error", event.text)
            case run_events.RunEnded():
                self._ended(event)
        self.pace.stand(self.prompt is not None or self.state is not ControlState.EXECUTE, now_s)

    def take_live(self, data: "LiveData", now_s: float) -> None:
        """Take a value that is watched."""
        if data.step is not None:
            self._step(data.step)
        self.live[data.name] = LiveValue(data, now_s).after(self.live.pop(data.name, None))

    def take_beam(self, beam: "BeamStatus", now_s: float) -> None:
        """Take the beam as the bench has it."""
        from catseye.app.protocol.run_events import LiveData

        text = "the beam returns" if beam.beam_ok else "NO BEAM"
        data = LiveData(
            name="signal",
            value=beam.signal or 0.0,
            unit="",
            low=None,
            high=None,
            accepted=beam.beam_ok,
            text=text,
        )
        self.beam = LiveValue(data, now_s - beam.age_s).after(self.beam)

    def begin_phase(self) -> None:
        """Something else is done from now on: what was watched belongs to what was before."""
        self.beam = None
        for value in self.live.values():
            value.fresh = False

    def _step(self, step: "LiveStepData") -> None:
        """Take a step; another series, or one that is recorded anew, begins another staircase."""
        last = self.staircase[-1] if self.staircase else None
        if last is not None and (last.series != step.series or last.number >= step.number):
            self.staircase = []
        self.staircase.append(step)

    def _happened(self, event: "FirstMotionShown | Happened", kind: str) -> None:
        data = event.json_object()["data"]
        if not isinstance(data, dict):
            return
        if kind in NOT_LOGGED:
            return
        # The first screen is painted before this is imported.
        from catseye.app.results.runs.event_text import event_text, texts_of
        from catseye.app.store.reader import StoredEvent

        text = event_text(StoredEvent(0, event.t, kind, data), texts_of(self.procedure))
        if text:
            self._note(event, "info", text)

    def _ended(self, event: "RunEnded") -> None:
        self.ended, self.active, self.prompt = event, False, None
        self.path = event.path or self.path
        level = "info" if event.status == "complete" else "error"
        self._note(event, level, f"run {event.status}" + (f": {event.text}" if event.text else ""))

    def _note(self, event: "Event", level: str, text: str) -> None:
        self.log.append(LogLine(event.t, level, text))
