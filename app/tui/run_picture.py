"""A run as the engine's events tell it."""

from collections import deque
from dataclasses import dataclass, field
from typing import Any, Final, Literal

from catseye.drivers.roles.text import harmless_lines

Event = dict[str, Any]

LOG_LINES: Final = 2000
VALUES_KEPT: Final = 600

UNTOLD: Final = frozenset({"map-known", "devices", "asked"})
"""Kinds of events that are shown elsewhere than in the log."""

_ENDED: Final = frozenset({"COMPLETE", "STOPPED", "ABORTED"})


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
class Seen:
    """A value as it was told once.

    Attributes:
        at_s: when it came, monotonic s.
        value: then.
        low: smallest accepted then; None for no limit.
        high: largest accepted then; None for no limit.
    """

    at_s: float
    value: float
    low: float | None
    high: float | None

    @property
    def accepted(self) -> bool:
        """The value lies inside its band."""
        return (self.low is None or self.value >= self.low) and (self.high is None or self.value <= self.high)


@dataclass(frozen=True)
class SoFar:
    """What the record of a run holds that began before this client came.

    Attributes:
        steps: id and title of the steps that are done, in order.
        points: last rows of distances, oldest first.
        point_count: of all rows.
        map_known: how well the maps were known, oldest first.
        log: what happened, oldest first.
        command: words of `catseye` that rehearse the same run; empty where they are not known.
        speed: bench seconds in one real second; None where it is not known.
    """

    steps: list[tuple[str, str]]
    points: list[Event]
    point_count: int
    map_known: list[Event]
    log: list[LogLine]
    command: tuple[str, ...] = ()
    speed: float | None = None


@dataclass
class LiveValue:
    """A value that is watched while it changes.

    Attributes:
        name: of the quantity.
        value: now.
        unit: of value and band.
        low: smallest accepted; None for no limit.
        high: largest accepted; None for no limit.
        text: what to do about it.
        at_s: when it came, monotonic s.
        history: as it was told, oldest first.
    """

    name: str
    value: float
    unit: str
    low: float | None
    high: float | None
    text: str
    at_s: float
    history: deque[Seen] = field(default_factory=lambda: deque(maxlen=VALUES_KEPT))

    @property
    def accepted(self) -> bool:
        """The value lies inside its band."""
        return Seen(self.at_s, self.value, self.low, self.high).accepted


@dataclass
class RunPicture:
    """One run.

    Attributes:
        name: of the run.
        procedure: its name.
        title: one line for people.
        since_s: when this client first heard of it, monotonic s.
        path: of its directory; empty until it is known.
        simulated: None until the devices are known.
        active: it has not ended.
        state: in PackML words.
        reason: why it is in that state.
        steps: that were begun, oldest first.
        progress: last event about progress.
        progress_at_s: when it came.
        live: values by name.
        newest_live: name of the value that came last.
        prompt: the open question.
        prompt_at_s: when it came.
        points: last rows, oldest first.
        points_seen: how many points were told.
        map_known: how well the maps were known, oldest first.
        log: lines, oldest first.
        ended: the event of its end.
        recorded: its record was asked for what happened before this client came.
        command: words of `catseye` that rehearse the same run; empty until they are known.
        speed: bench seconds in one real second; None until it is known.
    """

    name: str
    procedure: str
    title: str
    since_s: float
    path: str = ""
    simulated: bool | None = None
    active: bool = True
    state: str = "IDLE"
    reason: str = ""
    steps: dict[str, Step] = field(default_factory=dict)
    progress: Event | None = None
    progress_at_s: float = 0.0
    live: dict[str, LiveValue] = field(default_factory=dict)
    newest_live: str = ""
    prompt: Event | None = None
    prompt_at_s: float = 0.0
    points: deque[Event] = field(default_factory=lambda: deque(maxlen=5000))
    points_seen: int = 0
    map_known: deque[Event] = field(default_factory=lambda: deque(maxlen=2000))
    log: deque[LogLine] = field(default_factory=lambda: deque(maxlen=LOG_LINES))
    ended: Event | None = None
    recorded: bool = False
    command: tuple[str, ...] = ()
    speed: float | None = None

    @classmethod
    def of_snapshot(cls, snapshot: Event, now_s: float) -> "RunPicture":
        """Return a run that was under way when this client came."""
        run = cls(str(snapshot["run"]), str(snapshot["procedure"]), str(snapshot["title"]), now_s)
        run.path = str(snapshot.get("path") or "")
        run.simulated = snapshot.get("simulated")
        run.state, run.reason = str(snapshot["state"]), str(snapshot.get("reason") or "")
        run.active = run.state not in _ENDED
        run.prompt = snapshot.get("prompt")
        run.prompt_at_s = now_s - float(snapshot.get("prompt_open_s") or 0.0)
        for part in ("step", "progress", "live"):
            if isinstance(seen := snapshot.get(part), dict):
                run.take(seen, now_s)
        return run

    @property
    def current(self) -> Step | None:
        """The step under way."""
        return next((step for step in reversed(self.steps.values()) if step.status == "current"), None)

    def take_record(self, so_far: SoFar) -> None:
        """Take what the record holds; what was told meanwhile stays, behind it."""
        told, self.steps = self.steps, {}
        for step_id, title in so_far.steps:
            self.steps[step_id] = Step(step_id, title, "done")
        for step_id, step in told.items():
            if step_id not in self.steps or step.stored:
                self.steps[step_id] = step
        seen = {row["step"] for row in self.points}
        self.points.extendleft(row for row in reversed(so_far.points) if row["step"] not in seen)
        self.points_seen = max(self.points_seen, so_far.point_count)
        known = [each for each in so_far.map_known if each not in self.map_known]
        self.map_known.extendleft(reversed(known))
        first = self.log[0].t if self.log else ""
        lately = {(line.t[:19], line.text) for line in self.log}
        before = [line for line in so_far.log if not first or line.t < first]
        self.log.extendleft(line for line in reversed(before) if (line.t[:19], line.text) not in lately)
        self.recorded, self.command, self.speed = True, so_far.command, so_far.speed

    def lost_sight(self) -> None:
        """It ended unseen."""
        self.active, self.prompt = False, None

    def take(self, event: Event, now_s: float) -> None:
        """Take an event of this run."""
        match event["event"]:
            case "state" if event.get("kind") == "live":
                self._live(event["data"], now_s)
            case "state" if "kind" in event:
                self._happened(event)
            case "state":
                self.state, self.reason = str(event["state"]), str(event.get("reason") or "")
                self._say(event, "info", f"{self.state}: {self.reason}" if self.reason else self.state)
            case "step-started":
                # Begun anew it stands at the end again.
                self.steps.pop(str(event["step"]), None)
                self.steps[str(event["step"])] = Step(str(event["step"]), str(event["title"]), "current")
            case "step-done":
                step = self.steps.setdefault(
                    str(event["step"]), Step(str(event["step"]), str(event["title"]), "current")
                )
                step.status, step.stored = "done", bool(event.get("stored"))
            case "point":
                self.points.append({"step": event["step"], **event["point"]})
                self.points_seen += 1
            case "progress":
                self.progress, self.progress_at_s = event, now_s
            case "prompt":
                self.prompt, self.prompt_at_s = event, now_s
            case "answer":
                self.prompt = None
                self._say(event, "info", f"{event['id']}: {event['answer']} ({event['who']})")
            case "warning" | "error":
                self._warning(event)
            case "run-ended":
                self._ended(event)

    def _live(self, data: Event, now_s: float) -> None:
        name = str(data["name"])
        known = self.live.get(name)
        value = LiveValue(
            name, float(data["value"]), str(data["unit"]), data["low"], data["high"], str(data["text"]), now_s
        )
        if known is not None:
            value.history = known.history
        value.history.append(Seen(now_s, value.value, value.low, value.high))
        self.live[name], self.newest_live = value, name

    def _happened(self, event: Event) -> None:
        data = event.get("data") or {}
        if event["kind"] == "map-known":
            self.map_known.append(data)
        if event["kind"] in UNTOLD:
            return
        # The first screen is painted before this is imported.
        from catseye.app.store.reader import StoredEvent
        from catseye.app.story.words import event_text

        text = event_text(StoredEvent(0, str(event.get("t") or ""), str(event["kind"]), data))
        if text:
            self._say(event, "info", text)

    def _warning(self, event: Event) -> None:
        if isinstance(data := event.get("data"), dict) and data.get("simulated"):
            self.simulated = True
        self._say(event, str(event["event"]), str(event["text"]))

    def _ended(self, event: Event) -> None:
        self.ended, self.active, self.prompt = event, False, None
        self.path = str(event.get("path") or self.path)
        level = "info" if event.get("status") == "complete" else "error"
        text = str(event.get("text") or "")
        self._say(event, level, f"run {event['status']}" + (f": {text}" if text else ""))

    def _say(self, event: Event, level: str, text: str) -> None:
        self.log.append(LogLine(str(event.get("t") or ""), level, text))
