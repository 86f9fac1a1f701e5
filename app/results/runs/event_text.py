"""What was stored, in words."""

from collections.abc import Callable, Mapping
from datetime import datetime
from typing import Any

from catseye.app.results.numbers import duration_text
from catseye.app.store.reader import StoredEvent

Data = Mapping[str, Any]

_LONGEST = 160
_SHORT = 90


def gap_text(seconds: float) -> str:
    """Return a duration as people read it, short ones to a tenth of a second."""
    if seconds < 0.0:
        return "an unknown time (the clock was set back)"
    return duration_text(seconds)


def between_s(first_utc: str, last_utc: str) -> float:
    """Return the time between two ISO 8601 times, s."""
    return (datetime.fromisoformat(last_utc) - datetime.fromisoformat(first_utc)).total_seconds()


def event_text(event: StoredEvent) -> str:
    """Return what happened, as a sentence; empty when another line of the timeline says it."""
    phrase = _WORDS.get(event.kind)
    return phrase(event.data) if phrase else plain(event.kind, event.data)


def plain(kind: str, data: Data) -> str:
    """Return anything that was stored, by its names."""
    parts = ", ".join(f"{key} {_value(value)}" for key, value in data.items() if value not in (None, ""))
    text = f"{kind}: {parts}" if parts else kind
    return text if len(text) <= _LONGEST else text[: _LONGEST - 1] + "…"


def first_motion_text(data: Data) -> str:
    """Return where the arm stands before its first motion, and where it is led."""
    stands = data.get("stands")
    start = _pose_text(stands) if stands else "where it is"
    return f"first motion: from {start} to {', then '.join(map(_pose_text, data['way']))} (J1, J2, J3, J4)"


def _pose_text(pose: list[float]) -> str:
    return " ".join(f"{value:.2f}{unit}" for value, unit in zip(pose, ("°", "°", " mm", "°"), strict=True))


def device_text(facts: Data) -> str:
    """Return who answered."""
    parts = (
        facts.get("model"),
        facts.get("firmware"),
        f"no. {facts['serial']}" if facts.get("serial") else "",
    )
    return " ".join(str(part) for part in parts if part)


def _value(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _state(data: Data) -> str:
    return f"{data['state']}: {data['reason']}" if data.get("reason") else str(data["state"])


def _beam_lost(data: Data) -> str:
    where = f" {data['reflector']}" if data.get("reflector") else ""
    if isinstance(data.get("point"), int):
        where += f", on the way to point {data['point'] + 1}"
    elif data.get("where"):
        where += f", {data['where']}"
    known = ("reflector", "point", "where", "segment", "cause")
    rest = {key: value for key, value in data.items() if key not in known}
    text = f"BEAM LOST:{where}; segment {data.get('segment')} ends"
    if data.get("cause"):
        text += f"; cause: {data['cause']}"
    return text + (f" ({plain('', rest).removeprefix(': ')})" if rest else "")


def _entry(data: Data) -> str:
    point, targets = int(data.get("point", 0)) + 1, data.get("targets")
    return f"{data.get('reflector')}: the arm enters at point {point}, by {targets} targets"


def _known(data: Data) -> str:
    text = str(data.get("text"))
    return text if len(text) <= _SHORT else text[: _SHORT - 1] + "…"


def _left_out(data: Data) -> str:
    return f"{data.get('reflector')}: point {int(data.get('point', 0)) + 1} LEFT OUT: {data.get('reason')}"


def _dropped(data: Data) -> str:
    rows = data.get("rows")
    kept = f"; {rows} row(s) were not kept" if rows else ""
    return f"attempt {data.get('attempt')} at {data.get('step_id')} dropped: {data.get('error')}{kept}"


def _control(data: Data) -> str:
    by = data.get("by") or "nobody"
    before = f", before: {data['before']}" if data.get("before") else ""
    return f"control {data.get('what')}: {by}{before}"


def _client_lost(data: Data) -> str:
    client, who = data.get("client"), data.get("who")
    return f"front end {client} ({who}) lost: {data.get('reason')}; the run is to {data.get('policy')}"


def _ended(data: Data) -> str:
    text = f"ENDED {data.get('status')}, exit code {data.get('exit_code')}"
    text += f": {data['text']}" if data.get("text") else ""
    cut = data.get("wire_lines_cut")
    return text + (f"; {cut} lines are missing in wire.log, which was full" if cut else "")


def _warning(data: Data) -> str:
    # The banner above the timeline says it already.
    return "" if data.get("simulated") else f"WARNING: {data.get('text')}"


def _moved(data: Data) -> str:
    return (
        f"reflectors or interferometer MOVED since {str(data.get('since_utc'))[:19]}: the run never goes on"
    )


def _hands(data: Data) -> str:
    did = {"turn_screw": f"turned the {data.get('screw')} screw by {data.get('turns')} turns"}
    what = did.get(str(data.get("op"))) or plain("did", data)
    return f"the emulated operator's hands {what}"


def _aim(data: Data) -> str:
    verdict = "the aim holds over the whole plan" if data.get("holds") else "the aim does not hold yet"
    worst, room = data.get("worst_uncertainty_mm"), data.get("room_mm")
    reserve = f": {worst:.2f} mm at worst (k = 1), {room:.2f} mm allowed (k = 2)" if worst and room else ""
    return f"{verdict}{reserve}, {data.get('poses')} poses"


def _warmup(data: Data) -> str:
    rate, u = data.get("drift_um_per_10min"), data.get("u_drift_um_per_10min")
    known = "drift not known" if rate is None else f"drift {rate:+.1f} ± {u or 0.0:.1f} µm in 10 min"
    verdict = "WARM" if data.get("warm") else "NOT WARM"
    elapsed_min = float(data.get("elapsed_min", 0.0))
    return (
        f"{verdict}: {known}, limit {_value(data.get('limit_um_per_10min'))} µm in 10 min, "
        f"{data.get('visits')} visits to {data.get('reflector')} in {elapsed_min:.0f} min"
    )


def _along_beam(data: Data) -> str:
    where = f"pose {data.get('pose')}, along the beam to {data.get('reflector')}"
    if data.get("refused"):
        return f"{where}: no result: {data['refused']}"
    return (
        f"{where}: S = {data['s_um']:.1f} µm (95 %: {data['s_low_um']:.1f}…{data['s_high_um']:.1f}), "
        f"RP = ±{data['rp_um']:.1f} µm, range {data['range_um']:.1f} µm, drift {data['drift_um']:+.1f} µm"
    )


def _position(data: Data) -> str:
    if data.get("refused"):
        return f"pose {data.get('pose')}, position: no result: {data['refused']}"
    return f"pose {data.get('pose')}, position: RP = {data['rp_um']:.1f} ± {data['u_rp_um']:.1f} µm"


_WORDS: Mapping[str, Callable[[Data], str]] = {
    "run-opened": lambda _data: "the record is open",
    "run-reopened": lambda data: f"the run goes on; before: {data.get('before')}",
    "aim": _aim,
    "warmup": _warmup,
    "repeatability": _along_beam,
    "position-repeatability": _position,
    # A warning or the summary tells the rest.
    "height": lambda data: f"beam at J3 = {float(data['j3_mm']):.2f} ± {float(data['u_j3_mm']):.2f} mm",
    "state": _state,
    "warning": _warning,
    "error": lambda data: f"ERROR: {data.get('text')}",
    "ready": lambda data: f"drives on, override {_value(data.get('override_percent'))} %",
    "first-motion": first_motion_text,
    "drives": lambda data: str(data.get("text")),
    "override": lambda data: f"override lowered to {_value(data.get('percent'))} %",
    "zero": lambda data: (
        f"count zeroed (no. {data.get('number')}), dead path {float(data.get('dead_path_mm', 0.0)):.2f} mm"
    ),
    "beam-lost": _beam_lost,
    "entry": _entry,
    "point-left-out": _left_out,
    "closure-left-out": lambda data: f"{data.get('reflector')}: closure visit left out: {data.get('reason')}",
    "map-known": _known,
    "step-dropped": _dropped,
    "control": _control,
    "client-lost": _client_lost,
    "run-ended": _ended,
    "reflectors-moved": _moved,
    "hands": _hands,
    "close-failed": lambda data: plain("NOT CLOSED", data),
    # These are shown with what belongs to them.
    "asked": lambda _data: "",
}
