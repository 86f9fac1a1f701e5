"""What was stored, in words."""

from collections.abc import Mapping, Sequence
from datetime import datetime
from functools import cache
from typing import Final

from catseye.app.protocol.bench import AxisName
from catseye.app.protocol.procedures import declared_by
from catseye.app.results.numbers import duration_text
from catseye.app.store.lines import HEALS
from catseye.app.store.reader import StoredEvent
from catseye.procedures.kit.beam.loss import LOSS_TEXTS
from catseye.procedures.kit.event_text import Data, EventText, EventTexts, plain_text, value_text


def gap_text(seconds: float) -> str:
    """Return a duration as people read it, short ones to a tenth of a second."""
    if seconds < 0.0:
        return "an unknown time (the clock was set back)"
    return duration_text(seconds)


def between_s(first_utc: str, last_utc: str) -> float:
    """Return the time between two ISO 8601 times, s."""
    return (datetime.fromisoformat(last_utc) - datetime.fromisoformat(first_utc)).total_seconds()


def event_text(event: StoredEvent, texts: EventTexts) -> str:
    """Return what happened, as a sentence; empty when another line of the timeline says it.

    Args:
        texts: what `texts_of` returns for the run's procedure.
    """
    phrase = texts.get(event.kind)
    return phrase.sentence(event.kind, event.data) if phrase else plain_text(event.kind, event.data)


@cache
def texts_of(procedure: str) -> EventTexts:
    """Return how the events of a procedure's runs are phrased; by their names where it is not installed."""
    declared = declared_by(procedure)
    return {**_ENGINES, **LOSS_TEXTS, **(declared.event_texts if declared else {})}


def heals_text(heals: Mapping[str, int]) -> str:
    """Return how often the links of each device were healed; empty where none was."""
    return ", ".join(f"{device} {count}×" for device, count in heals.items())


def first_motion_text(data: Data) -> str:
    """Return where the arm stands before its first motion, and where it is led."""
    axes = [AxisName.model_validate(axis) for axis in data.get("axes") or ()]
    start = _pose_text(axes, data["stands"]) if data.get("stands") else "where it is"
    return f"first motion: from {start} to {', then '.join(_pose_text(axes, pose) for pose in data['way'])}"


def _pose_text(axes: Sequence[AxisName], pose: Sequence[float]) -> str:
    if len(axes) != len(pose):
        # Runs of older programs do not state the axes.
        return " ".join(f"{value:.2f}" for value in pose)
    return " ".join(axis.text(value) for axis, value in zip(axes, pose, strict=True))


def device_text(facts: Data) -> str:
    """Return who answered."""
    parts = (
        facts.get("model"),
        facts.get("firmware"),
        f"no. {facts['serial']}" if facts.get("serial") else "",
    )
    return " ".join(str(part) for part in parts if part)


def _state(data: Data) -> str:
    return f"{data['state']}: {data['reason']}" if data.get("reason") else str(data["state"])


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


def _output_lost(data: Data) -> str:
    return f"what the run says is taken no more ({data.get('reason')}); the run is to {data.get('policy')}"


def _ended(data: Data) -> str:
    text = f"ENDED {data.get('status')}, exit code {data.get('exit_code')}"
    text += f": {data['text']}" if data.get("text") else ""
    text += f"; links healed: {heals}" if (heals := heals_text(data.get(HEALS, {}))) else ""
    cut = data.get("wire_lines_cut")
    return text + (f"; {cut} lines are missing in wire.log, which was full" if cut else "")


def _warning(data: Data) -> str:
    # The banner above the timeline says it already.
    return "" if data.get("simulated") else f"WARNING: {data.get('text')}"


def _moved(data: Data) -> str:
    return (
        f"reflectors or interferometer MOVED since {str(data.get('since_utc'))[:19]}: the run never goes on"
    )


def _set_up_lost(data: Data) -> str:
    return f"the set-up was MOVED since {str(data.get('since_utc'))[:19]}: it is set up again as needed"


def _hands(data: Data) -> str:
    did = {
        "turn_screw": f"turned the {data.get('screw')} screw by {data.get('turns')} turns",
        "mount_interferometer": f"mounted the interferometer turned by {data.get('turned_deg')}°",
    }
    what = did.get(str(data.get("op"))) or plain_text("did", data)
    return f"the emulated operator's hands {what}"


_ENGINES: Final[EventTexts] = {
    kind: EventText(text)
    for kind, text in {
        "run-opened": lambda _data: "the record is open",
        "run-reopened": lambda data: f"the run goes on; before: {data.get('before')}",
        "state": _state,
        "warning": _warning,
        "error": lambda data: f"ERROR: {data.get('text')}",
        "ready": lambda data: f"drives on, override {value_text(data.get('override_percent'))} %",
        "first-motion": first_motion_text,
        "drives": lambda data: str(data.get("text")),
        "override": lambda data: f"override lowered to {value_text(data.get('percent'))} %",
        "zero": lambda data: (
            f"count zeroed (no. {data.get('number')}), dead path {float(data.get('dead_path_mm', 0.0)):.2f} mm"
        ),
        "step-dropped": _dropped,
        "control": _control,
        "client-lost": _client_lost,
        "output-lost": _output_lost,
        "output-missed": lambda data: f"{data.get('events')} events were told to nobody; the record has them",
        "run-ended": _ended,
        "reflectors-moved": _moved,
        "set-up-lost": _set_up_lost,
        "hands": _hands,
        "close-failed": lambda data: plain_text("NOT CLOSED", data),
        # These are shown with what belongs to them.
        "asked": lambda _data: "",
    }.items()
}
