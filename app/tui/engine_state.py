"""What the engine has sent so far: the only thing that screens show."""

from collections import Counter, deque
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Final

from catseye.app.protocol.state import HELD, ControlState
from catseye.app.tui.run_state import LogLine, RunState

if TYPE_CHECKING:
    # The first screen is painted before these are imported.
    from catseye.app.protocol.bench import BenchStatus, RobotStatus, Samples, WireLine
    from catseye.app.protocol.engine_events import Client, DrivesFields, JogFields, LeftOverride, RawChanged
    from catseye.app.protocol.events import AnyEvent, Unknown, Unread
    from catseye.app.protocol.message import Event
    from catseye.app.protocol.scara.layout import Layout, ReflectorPlace
    from catseye.app.protocol.snapshot import Snapshot

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
    """Everything that is known of engine, bench and run. `take` is the only way in for events.

    Attributes:
        connected: to an engine.
        trouble: why there is no engine, and what to do; empty when connected.
        silent_since_s: since when the engine does not answer, monotonic s; None while it does.
        snapshot: what the engine said when this client came, another one for each connection; None before the first.
        clients: who is connected.
        control: who holds control; None when nobody does.
        state: of run or idle engine.
        reason: why it is in that state.
        aborted: why nothing begins, as long as nobody has cleared it.
        run: under way, or the last one that was seen to its end.
        bench: as it was last; None before the first message about it.
        bench_at_s: when it came, on this process's monotonic clock.
        strip: displacement of the beam, oldest first.
        strip_seen: columns ever, those that were missed included.
        strip_period_s: bench time of one column.
        strip_at_s: when the last columns came.
        jog: as it was last; None before the first.
        emulated_speed: of its emulators, which live as long as it does; None without any.
        override_left: what a jog has left of the speed override; None where nothing is to be set again.
        drives_off_at_s: when the drives go off by themselves, monotonic s; None while nobody counts down to that.
        wire: raw traffic, oldest first.
        wire_seen: lines of it ever.
        raw: who has taken a device's link from its driver, by device.
        missed: messages of each kind that the engine or this client replaced or dropped.
        log: what happened outside of a run.
        revision: grows with every message.
        passed_over: what was said of messages that only a newer program can show.
        states_told: how often the engine has said which state it is in.
    """

    connected: bool = False
    trouble: str = ""
    silent_since_s: float | None = None
    snapshot: "Snapshot | None" = None
    clients: "tuple[Client, ...]" = ()
    control: "Client | None" = None
    state: ControlState = ControlState.IDLE
    reason: str = ""
    aborted: str = ""
    run: RunState | None = None
    bench: "BenchStatus | None" = None
    bench_at_s: float = 0.0
    strip: deque[Column] = field(default_factory=lambda: deque(maxlen=STRIP_COLUMNS))
    strip_seen: int = 0
    strip_period_s: float = 0.02
    strip_at_s: float = 0.0
    jog: "JogFields | None" = None
    emulated_speed: float | None = None
    override_left: "LeftOverride | None" = None
    drives_off_at_s: float | None = None
    wire: "deque[WireLine]" = field(default_factory=lambda: deque(maxlen=WIRE_LINES))
    wire_seen: int = 0
    raw: "dict[str, RawChanged]" = field(default_factory=dict)
    missed: Counter[str] = field(default_factory=Counter)
    log: deque[LogLine] = field(default_factory=lambda: deque(maxlen=500))
    revision: int = 0
    passed_over: set[str] = field(default_factory=set)
    states_told: int = 0

    @property
    def you(self) -> str | None:
        """The name of this client at the engine."""
        return None if self.snapshot is None else self.snapshot.you

    @property
    def in_control(self) -> bool:
        """This client holds control."""
        return self.control is not None and self.control.client == self.you

    @property
    def simulated(self) -> bool:
        """Some device is known to be an emulator."""
        if self.run is not None and self.run.active and self.run.simulated is not None:
            return self.run.simulated
        return self.bench_simulated is True

    @property
    def bench_simulated(self) -> bool | None:
        """All devices of the bench that are known are emulators; None while none is known."""
        return None if self.bench is None else self.bench.simulated

    @property
    def cell_name(self) -> str:
        """The name of the cell; empty while it is not known."""
        return "" if self.bench is None else self.bench.cell

    @property
    def robot(self) -> "RobotStatus | None":
        """The controller, where it is known."""
        return None if self.bench is None else self.bench.robot

    @property
    def layout(self) -> "Layout | None":
        """The bench of a SCARA; None of any other, and while none is known."""
        return None if self.bench is None else self.bench.layout

    @property
    def reflectors(self) -> "tuple[ReflectorPlace, ...]":
        """The reflectors of the bench; none while it is not known."""
        return () if self.layout is None else self.layout.reflectors

    @property
    def running(self) -> bool:
        """A run is under way."""
        return self.connected and self.run is not None and self.run.active

    @property
    def held(self) -> bool:
        """A run waits for being let go."""
        return self.running and self.state in HELD

    @property
    def run_out_of_sight(self) -> bool:
        """A run was under way when the connection broke."""
        return not self.connected and self.run is not None and self.run.active

    @property
    def jogging(self) -> bool:
        """The arm may move by hand."""
        return self.connected and self.jog is not None and self.jog.on

    def met(self, snapshot: "Snapshot", now_s: float) -> None:
        """Begin anew from an engine's snapshot."""
        self.connected, self.trouble, self.silent_since_s = True, "", None
        self.snapshot = snapshot
        self.clients, self.control = snapshot.clients, snapshot.control
        self.state, self.reason = snapshot.state, snapshot.reason or ""
        self.states_told += 1
        self._compare_versions(snapshot.engine)
        self.aborted = snapshot.aborted or ""
        self.jog, self.override_left = snapshot.jog, snapshot.override_left
        self.emulated_speed = snapshot.emulated_speed
        self._drives(snapshot.drives, now_s)
        self.raw = {}
        # Nobody knows how much time has passed unseen.
        self.strip.clear()
        if snapshot.run is not None:
            self.run = RunState.of_snapshot(snapshot, now_s)
        elif self.run is not None and self.run.active:
            # It ended while nobody here was connected; how is in its record.
            self.run.lost_sight()
        self.revision += 1

    def lost(self, trouble: str) -> None:
        """The engine is gone, or was never there."""
        self.connected, self.trouble, self.silent_since_s = False, trouble, None
        self.control, self.jog, self.bench, self.drives_off_at_s = None, None, None, None
        self.override_left, self.emulated_speed = None, None
        self.clients, self.raw = (), {}
        self.revision += 1

    def take(self, event: "AnyEvent", now_s: float) -> None:
        """Take an event.

        Args:
            now_s: monotonic time of its arrival, s.
        """
        from catseye.app.protocol import engine_events
        from catseye.app.protocol.events import Unknown, Unread

        self.revision += 1
        match event:
            case engine_events.BenchSeen():
                self.take_bench(event, now_s)
            case engine_events.SamplesTaken():
                self._samples(event, now_s)
            case engine_events.WirePassed():
                self.wire.extend(event.lines)
                self.wire_seen += len(event.lines)
                self.missed["wire"] += event.missed
            case engine_events.JogChanged():
                self.jog = event
            case engine_events.EmulatorsChanged():
                self.emulated_speed = event.speed
            case engine_events.OverrideLeft():
                self.override_left = event.left
                if event.reason:
                    self._note(event, "warning", event.reason)
            case engine_events.DrivesChanged():
                self._drives(event, now_s)
                if event.reason:
                    self._note(event, "warning" if event.on else "info", event.reason)
            case engine_events.RawChanged():
                self._raw(event)
            case engine_events.ControlChanged():
                self.control = event.holder
                self._note(event, "info", f"control {event.what}" + (f": {event.by}" if event.by else ""))
            case engine_events.ClientsChanged():
                self.clients = event.clients
            case engine_events.Dropped():
                self.missed["points and steps"] += event.count
            case engine_events.EngineIdle():
                self.state, self.reason = event.state, ""
            case engine_events.ClientLost():
                self._note(event, "warning", f"{event.who} ({event.client}) is lost: {event.reason}")
            case Unknown() | Unread():
                self._passed_over(event)
            case _:
                self._of_run(event, now_s)

    def take_bench(self, bench: "BenchStatus", now_s: float) -> None:
        """Take the bench as it is now.

        Args:
            now_s: monotonic time of its arrival, s.
        """
        self.bench, self.bench_at_s = bench, now_s
        self.missed["bench"] += bench.missed
        if self.run is not None and self.run.prompt is not None and bench.beam is not None:
            self.run.take_beam(bench.beam, now_s)

    def _of_run(self, event: "AnyEvent", now_s: float) -> None:
        from catseye.app.protocol import run_events

        match event:
            case run_events.RunStarted():
                self.drives_off_at_s = None
                self.run = RunState(event.run or "", event.procedure, event.title, now_s, seen_begin=True)
            case run_events.StateFields():
                self.state, self.reason = event.state, event.reason
                self.states_told += 1
                if event.state is not ControlState.ABORTED:
                    self.aborted = ""
                elif event.run is None:
                    # What was done by hand was aborted, or a run ended that nobody has acknowledged a stop of.
                    self.aborted = event.reason
            case run_events.RunEnded(status="aborted"):
                self.aborted = event.text or "aborted"
        if self.run is not None and event.run == self.run.name:
            self.run.take(event, now_s)
        elif isinstance(event, run_events.WarningIssued | run_events.ErrorReported):
            self._note(event, event.event, event.text)

    def _compare_versions(self, engine: str) -> None:
        """Say once that an engine is of another version."""
        from catseye.app.store.software import SOFTWARE, other_version_text

        text = other_version_text(engine)
        if engine != SOFTWARE and text not in self.passed_over:
            self.passed_over.add(text)
            self.log.append(LogLine("", "warning", text))

    def _passed_over(self, event: "Unknown | Unread") -> None:
        """Say once what this program cannot show."""
        from catseye.app.protocol.events import passed_over_text

        text = passed_over_text(event)
        if text not in self.passed_over:
            self.passed_over.add(text)
            self._note(event, "warning", text)

    def _samples(self, samples: "Samples", now_s: float) -> None:
        self.strip.extend(Column(None, None) for _ in range(min(samples.missed, STRIP_COLUMNS)))
        self.strip.extend(Column(low, high) for low, high in zip(samples.low, samples.high, strict=True))
        self.strip_seen += samples.missed + len(samples.low)
        self.strip_period_s, self.strip_at_s = samples.period_s, now_s
        self.missed["samples"] += samples.missed

    def _raw(self, event: "RawChanged") -> None:
        if event.on:
            self.raw[event.device] = event
        else:
            self.raw.pop(event.device, None)
            self._note(event, "info", f"{event.device} has its link again: {event.reason or event.by}")

    def _drives(self, drives: "DrivesFields | None", now_s: float) -> None:
        if drives is None or drives.off_at_utc is None:
            self.drives_off_at_s = None
        else:
            left = datetime.fromisoformat(drives.off_at_utc) - datetime.now(UTC)
            self.drives_off_at_s = now_s + left.total_seconds()

    def _note(self, event: "Event", level: str, text: str) -> None:
        line = LogLine(event.t, level, text)
        (self.run.log if self.run is not None and self.run.active else self.log).append(line)
