"""The instrument beside a serial arm as lines that people read."""

from typing import TYPE_CHECKING

from textual.content import Content

from catseye.app.results.numbers import PLAIN, listed, number

if TYPE_CHECKING:
    # The first screen is painted before this is imported.
    from catseye.app.protocol.bench import InstrumentStatus


def instrument_title(instrument: "InstrumentStatus") -> str:
    """Return what the instrument is: one that measures points is a tracker."""
    return "Tracker" if "points" in instrument.measures else "Optical CMM"


def instrument_lines(instrument: "InstrumentStatus") -> list[Content]:
    """Return what it measures, by which nests and targets, and where the arm's base stands for it."""
    base_mm, base_deg = (_triple(part) for part in (instrument.base_mm, instrument.base_deg))
    return [
        Content(f"measures {' and '.join(instrument.measures)}"),
        *_nest_lines(instrument),
        Content(f"targets  {listed(instrument.targets)}"),
        Content(f"base at  {base_mm} mm"),
        Content(f"  turned {base_deg} deg"),
    ]


def _nest_lines(instrument: "InstrumentStatus") -> list[Content]:
    """Return the nests of the world frame; an optical CMM measures against marks and needs none."""
    if instrument.nests:
        return [Content(f"nests    {listed(instrument.nests)}")]
    if "points" in instrument.measures:
        return [Content.styled("no nests: a drift cannot be seen", "$warning")]
    return []


def _triple(values: tuple[float, float, float]) -> str:
    return ", ".join(number(value, PLAIN) for value in values)
