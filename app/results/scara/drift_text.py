"""What changed during a measurement, as the distances show it."""

from typing import Final, Literal

from catseye.app.results.model import Sign, Statement
from catseye.app.results.numbers import EXPANDED, fixed, number
from catseye.app.results.scara.result import DriftPart, Estimate, Result
from catseye.calibration.scara.found_drift import FoundDrift

_UNITS: Final[dict[str, tuple[Literal["um", "ppm"], float]]] = {
    "length": ("um", 1e3),
    "scale": ("ppm", 1e6),
    "links": ("ppm", 1e6),
}
"""Unit of what changes, and what makes it of mm or of a share."""

_ONE = fixed(1)


def drift_part(found: FoundDrift) -> DriftPart:
    """Return a found drift as a result file states it."""
    unit, factor = _UNITS[found.contributor.kind]
    return DriftPart(
        contributor=found.contributor.name,
        kind=found.contributor.kind,
        unit=unit,
        change=Estimate(value=factor * found.change, u=factor * found.u_change),
        rms=Estimate(value=factor * found.rms, u=factor * found.u_rms),
        probability=found.probability,
        significant=found.significant,
    )


def drift_statements(result: Result) -> list[Statement]:
    """Return what changed during the measurement; nothing where scatter explains it."""
    return [Statement(Sign.ATTENTION, _text(part)) for part in result.drift or [] if part.significant]


def _expanded(value: float | None, u: float | None) -> str:
    return f"{number(value, _ONE)} ± {number(None if u is None else EXPANDED * u, _ONE)}"


def _text(part: DriftPart) -> str:
    unit, change = part.unit.replace("um", "µm"), part.change.value
    rms = f"{_expanded(part.rms.value, part.rms.u)} {unit} rms"
    ends = f"{_expanded(abs(change), part.change.u)} {unit} (k = 2)"
    match part.kind:
        case "links":
            what = (
                f"The links {'grew' if change > 0.0 else 'shrank'} by {ends} from first to last row ({rms})"
            )
            where = "the result states their mean, and predictions count it as uncertain"
        case "scale":
            what = f"The scale of the distances drifted by {rms} during the measurement"
            where = "keep the air steady, or correct for it more often"
        case _:
            what = f"The zero drifted by {rms} during the measurement"
            where = "the uncertainties include it; warm up, keep the air steady, check clamps"
    return f"{what}; {where} ({part.contributor})."
