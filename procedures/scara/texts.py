"""Events of a SCARA's procedures as sentences."""

from typing import Final

from catseye.procedures.kit.event_text import Data, EventText, EventTexts, value_text
from catseye.procedures.kit.expanded import EXPANDED, expanded_text

MAP_KNOWN: Final = "map-known"
"""Kind of the event that says how well the maps are known."""

_SHORT: Final = 90


def _aim(data: Data) -> str:
    verdict = "the aim holds over the whole plan" if data.get("holds") else "the aim does not hold yet"
    worst, room = data.get("worst_uncertainty_mm"), data.get("room_mm")
    reached = f": {EXPANDED * worst:.2f} mm at worst, {room:.2f} mm allowed (k = 2)" if worst and room else ""
    return f"{verdict}{reached}, {data.get('poses')} poses"


def _height(data: Data) -> str:
    # A warning or the summary says the rest.
    return f"beam at J3 = {expanded_text(float(data['j3_mm']), float(data['u_j3_mm']), 2)} mm (k = 2)"


def _warmup(data: Data) -> str:
    rate, u = data.get("drift_um_per_10min"), data.get("u_drift_um_per_10min")
    known = (
        "drift not known"
        if rate is None
        else f"drift {expanded_text(rate, u or 0.0, 1, signed=True)} µm in 10 min (k = 2)"
    )
    verdict = "WARM" if data.get("warm") else "NOT WARM"
    elapsed_min = float(data.get("elapsed_min", 0.0))
    return (
        f"{verdict}: {known}, limit {value_text(data.get('limit_um_per_10min'))} µm in 10 min, "
        f"{data.get('visits')} visits to {data.get('reflector')} in {elapsed_min:.0f} min"
    )


def _along_beam(data: Data) -> str:
    where = f"pose {data.get('pose')}, along the beam to {data.get('reflector')}"
    if data.get("refused"):
        return f"{where}: no result: {data['refused']}"
    drift_um = data.get("drift_um")
    drift = "drift not known" if drift_um is None else f"drift {drift_um:+.1f} µm"
    return (
        f"{where}: S = {data['s_um']:.1f} µm (95 %: {data['s_low_um']:.1f}…{data['s_high_um']:.1f}), "
        f"RP = ±{data['rp_um']:.1f} µm, range {data['range_um']:.1f} µm, {drift}"
    )


def _position(data: Data) -> str:
    if data.get("refused"):
        return f"pose {data.get('pose')}, position: no result: {data['refused']}"
    return f"pose {data.get('pose')}, position: RP = {expanded_text(data['rp_um'], data['u_rp_um'], 1)} µm (k = 2)"


def _entry(data: Data) -> str:
    point, targets = int(data.get("point", 0)) + 1, data.get("targets")
    return f"{data.get('reflector')}: the arm enters at point {point}, by {targets} targets"


def _known(data: Data) -> str:
    text = str(data.get("text"))
    return text if len(text) <= _SHORT else text[: _SHORT - 1] + "…"


def _mounted(data: Data) -> str:
    return f"the interferometer is mounted turned by {float(data['turned_deg']):.2f}° about the J4 axis"


def _left_out(data: Data) -> str:
    return f"{data.get('reflector')}: point {int(data.get('point', 0)) + 1} LEFT OUT: {data.get('reason')}"


def _closure_left_out(data: Data) -> str:
    return f"{data.get('reflector')}: closure visit left out: {data.get('reason')}"


def _error_motion(data: Data) -> str:
    expanded_um = EXPANDED * float(data["u_rms_um"])
    arc = f"{float(data['from_deg']):g}° … {float(data['to_deg']):g}°"
    return (
        f"{data.get('joint')}: radial error motion {float(data['rms_um']):.2f} µm rms, U = {expanded_um:.2f} µm "
        f"(k = 2), over {arc}"
    )


ERROR_MOTION: Final[EventTexts] = {"radial-error-motion": EventText(_error_motion, shown=True)}
AIM: Final[EventTexts] = {"aim": EventText(_aim)}
HEIGHT: Final[EventTexts] = {"height": EventText(_height)}
FOLLOWING: Final[EventTexts] = {"entry": EventText(_entry)}
WARMUP: Final[EventTexts] = {**FOLLOWING, "warmup": EventText(_warmup)}
REPEATABILITY: Final[EventTexts] = {
    **FOLLOWING,
    "repeatability": EventText(_along_beam),
    "position-repeatability": EventText(_position),
}
MEASUREMENT: Final[EventTexts] = {
    **FOLLOWING,
    "point-left-out": EventText(_left_out),
    "closure-left-out": EventText(_closure_left_out),
    "mounted": EventText(_mounted),
    MAP_KNOWN: EventText(_known, passing=True),
}
