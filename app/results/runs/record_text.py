"""What was observed beside the distances, in words."""

from collections.abc import Callable, Mapping
from typing import Any

from catseye.app.results.runs.event_text import plain

Row = Mapping[str, Any]

_KEYS = frozenset({"step_id", "attempt", "seq", "kind"})


def record_text(row: Row) -> str:
    """Return an observation in words."""
    own = {key: value for key, value in row.items() if key not in _KEYS}
    kind = str(row["kind"])
    phrase = _WORDS.get(kind)
    return phrase(own) if phrase else plain(kind, own)


def _alignment(row: Row) -> str:
    after = f" after: {row['instruction']}" if row.get("instruction") else ""
    return (
        f"alignment, round {row.get('round')}: {row.get('quantity')} {_value(row, 'value'):+.3g} ± "
        f"{_value(row, 'u'):.2g} {row.get('unit', '')}{after}"
    )


def _overlap(row: Row) -> str:
    return (
        f"{row.get('reflector')}: segment {row.get('segment')} tied to segment {row.get('previous_segment')} at "
        f"point {_point(row)}, measured again"
    )


def _closure(row: Row) -> str:
    return (
        f"{row.get('reflector')}: closure visit {row.get('number')}, drift {_value(row, 'drift_um'):+.1f} µm since "
        f"point {_point(row)}"
    )


def _drift(row: Row) -> str:
    return (
        f"{row.get('reflector')}: visit {row.get('visit')}, displacement {_value(row, 'displacement_mm'):.4f} mm, "
        f"air {_value(row, 'temperature_c'):.2f} °C"
    )


def _repeat(row: Row) -> str:
    return (
        f"{row.get('reflector')}: cycle {row.get('cycle')}, pose {row.get('pose')}, displacement "
        f"{_value(row, 'displacement_mm'):.4f} mm"
    )


def _screw(row: Row) -> str:
    return str(row.get("text") or plain("screw", row))


def _value(row: Row, key: str) -> float:
    value = row.get(key)
    return float(value) if isinstance(value, int | float) else float("nan")


def _point(row: Row) -> int:
    return int(row.get("point") or 0) + 1


_WORDS: Mapping[str, Callable[[Row], str]] = {
    "alignment": _alignment,
    "overlap": _overlap,
    "closure": _closure,
    "drift": _drift,
    "repeat": _repeat,
    "screw": _screw,
}
