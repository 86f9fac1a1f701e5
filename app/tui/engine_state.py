"""What the engine has told so far: the only thing that screens show."""

from collections import deque
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import Any, Final

from catseye.app.tui.run_state import LogLine, RunState

Event = dict[str, Any]
"""A message of the engine; docs/engine.md says what each carries."""

WIRE_LINES: Final = 5000
"""Lines of raw traffic that are kept for the screen."""

STRIP_COLUMNS: Final = 3000
"""Columns of the beam's displacement that are kept: a minute at 20 ms."""


@dataclass(frozen=True)
class Column:
    """Smallest and largest displacement in one period; None without a sample.

    Attributes:
        low_mm: smallest.
        high_mm: largest.
    """

    low_mm: float | None
    high_mm: float | None


@dataclass
class EngineState:
    """Everything that is known of engine, bench and run. `take` is its only way in.

    Attributes:
        connected: to an engine.
        trouble: why there is no engine, and what to do; empty when connected.
        silent_since_s: since when the engine does not answer, monotonic s; None while it does.
        facts: of the engine's snapshot that no event changes: version, pid, cell, runs, you.
        clients: who is connected.
        control: who holds control: client and who; None when nobody does.
        state: of run or idle engine, in PackML words.
        reason: why it is in that state.
        aborted: why nothing begins, as long as nobody has cleared it.
        run: under way, or the last one that was seen to its end.
        bench: last message about the bench; None before the first.
        bench_at_s: when it came, on this process's monotonic clock.
        strip: displacement of the beam, oldest first.
        strip_seen: columns ever, those that were missed included.
        strip_period_s: bench time of one column.
        strip_at_s: when the last columns came.
        jog: last message about jogging.
        drives_off_at_s: when the drives go off by themselves, monotonic s; None while nobody counts down to that.
        wire: raw traffic, oldest first.
        wire_seen: lines of it ever.
        raw: who has taken a device's link from its driver, by device.
        missed: messages of each kind that the engine or this client replaced or dropped.
        log: what happened outside of a run.
        revision: grows with every message.
    """

    connected: bool = False
    trouble: str = ""
    silent_since_s: float | None = None
    facts: Event = field(default_factory=dict)
    clients: list[Event] = field(default_factory=list)
    control: Event | None = None
    state: str = "IDLE"
    reason: str = ""
    aborted: str = ""
    run: RunState | None = None
    bench: Event | None = None
    bench_at_s: float = 0.0
    strip: deque[Column] = field(default_factory=lambda: deque(maxlen=STRIP_COLUMNS))
    strip_seen: int = 0
    strip_period_s: float = 0.02
    strip_at_s: float = 0.0
    jog: Event | None = None
    drives_off_at_s: float | None = None
    wire: deque[Event] = field(default_factory=lambda: deque(maxlen=WIRE_LINES))
    wire_seen: int = 0
    raw: dict[str, str] = field(default_factory=dict)
    missed: dict[str, int] = field(default_factory=dict)
    log: deque[LogLine] = field(default_factory=lambda: deque(maxlen=500))
    revision: int = 0

    @property
    def you(self) -> str:
        """The name of this client at the engine."""
        return str(self.facts.get("you") or "")

    @property
    def in_control(self) -> bool:
        """This client holds control."""
        return self.control is not None and self.control.get("client") == self.you

    @property
    def simulated(self) -> bool:
        """Some device is known to be an emulator."""
        if self.run is not None and self.run.active and self.run.simulated is not None:
            return self.run.simulated
        return bool(self.bench and self.bench.get("simulated"))

    @property
    def running(self) -> bool:
        """A run is under way."""
        return self.connected and self.run is not None and self.run.active

    @property
    def run_out_of_sight(self) -> bool:
        """A run was under way when the connection broke."""
        return not self.connected and self.run is not None and self.run.active

    @property
    def jogging(self) -> bool:
        """The arm may move by hand."""
        return self.connected and self.jog is not None and bool(self.jog.get("on"))

    def met(self, snapshot: Event, now_s: float) -> None:
        """Begin anew from an engine's snapshot."""
        self.connected, self.trouble, self.silent_since_s = True, "", None
        self.facts = snapshot
        self.clients = list(snapshot.get("clients") or [])
        self.control = snapshot.get("control")
        self.state = str(snapshot.get("state") or "IDLE")
        self.reason = str(snapshot.get("reason") or "")
        self.aborted = str(snapshot.get("aborted") or "")
        self.jog = snapshot.get("jog")
        self._drives(snapshot.get("drives") or {}, now_s)
        self.raw = {}
        # Nobody knows how much time has passed unseen.
        self.strip.clear()
        if snapshot.get("run") is not None:
            self.run = RunState.of_snapshot(snapshot, now_s)
        elif self.run is not None and self.run.active:
            # It ended while nobody here was connected; how is in its record.
            self.run.lost_sight()
        self.revision += 1

    def lost(self, trouble: str) -> None:
        """The engine is gone, or was never there."""
        self.connected, self.trouble, self.silent_since_s = False, trouble, None
        self.control, self.jog, self.bench, self.drives_off_at_s = None, None, None, None
        self.clients, self.raw = [], {}
        self.revision += 1

    def take(self, event: Event, now_s: float) -> None:
        """Take a message.

        Args:
            event: of the engine.
            now_s: monotonic time of its arrival, s.
        """
        self.revision += 1
        match event["event"]:
            case "bench":
                self._bench(event, now_s)
            case "samples":
                self._samples(event, now_s)
            case "wire":
                self.wire.extend(event["lines"])
                self.wire_seen += len(event["lines"])
                self._count("wire", event.get("missed"))
            case "jog":
                self.jog = event
            case "drives":
                self._drives(event, now_s)
                if event.get("reason"):
                    self._say(event, "warning" if event.get("on") else "info", str(event["reason"]))
            case "run-started":
                self.drives_off_at_s = None
                self._of_run(event, now_s)
            case "raw":
                self._raw(event)
            case "control":
                self._control(event)
            case "clients":
                self.clients = list(event["clients"])
            case "dropped":
                self._count("points and steps", event["count"])
            case "idle":
                self.state, self.reason = str(event["state"]), ""
            case "client-lost":
                self._say(event, "warning", f"{event['who']} ({event['client']}) is lost: {event['reason']}")
            case _:
                self._of_run(event, now_s)

    def _of_run(self, event: Event, now_s: float) -> None:
        if event["event"] == "run-started":
            self.run = RunState(str(event["run"]), str(event["procedure"]), str(event["title"]), now_s)
        if event["event"] == "state" and "kind" not in event:
            self.state, self.reason = str(event["state"]), str(event.get("reason") or "")
            if self.state != "ABORTED":
                self.aborted = ""
            elif event.get("run") is None:
                # What was done by hand was aborted, or a run ended that nobody has acknowledged a stop of.
                self.aborted = self.reason
        if event["event"] == "run-ended" and event.get("status") == "aborted":
            self.aborted = str(event.get("text") or "aborted")
        if self.run is not None and event.get("run") == self.run.name:
            self.run.take(event, now_s)
        elif event["event"] in {"warning", "error"}:
            self._say(event, str(event["event"]), str(event["text"]))

    def _bench(self, event: Event, now_s: float) -> None:
        self.bench, self.bench_at_s = event, now_s
        self._count("bench", event.get("missed"))

    def _samples(self, event: Event, now_s: float) -> None:
        missed = int(event.get("missed") or 0)
        self.strip.extend(Column(None, None) for _ in range(min(missed, STRIP_COLUMNS)))
        self.strip.extend(Column(low, high) for low, high in zip(event["low"], event["high"], strict=True))
        self.strip_seen += missed + len(event["low"])
        self.strip_period_s, self.strip_at_s = float(event["period_s"]), now_s
        self._count("samples", event.get("missed"))

    def _raw(self, event: Event) -> None:
        device, by = str(event["device"]), str(event.get("by") or "")
        if event["on"]:
            self.raw[device] = by
        else:
            self.raw.pop(device, None)
            self._say(event, "info", f"{device} has its link again: {event.get('reason') or by}")

    def _drives(self, told: Event, now_s: float) -> None:
        off_at_utc = told.get("off_at_utc")
        if off_at_utc is None:
            self.drives_off_at_s = None
        else:
            left = datetime.fromisoformat(str(off_at_utc)) - datetime.now(UTC)
            self.drives_off_at_s = now_s + left.total_seconds()

    def _control(self, event: Event) -> None:
        who = event.get("by")
        self.control = None if who is None else _holder(str(who))
        if event.get("what") != "held from the start":
            self._say(event, "info", f"control {event['what']}" + (f": {who}" if who else ""))

    def _say(self, event: Event, level: str, text: str) -> None:
        line = LogLine(str(event.get("t") or ""), level, text)
        (self.run.log if self.run is not None and self.run.active else self.log).append(line)

    def _count(self, kind: str, more: Any) -> None:
        if isinstance(more, int) and more:
            self.missed[kind] = self.missed.get(kind, 0) + more


def _holder(text: str) -> Event:
    """Return client and person of `who (client)`, as the engine writes them."""
    who, _, client = text.rpartition(" (")
    return {"client": client.removesuffix(")"), "who": who}
