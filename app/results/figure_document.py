"""Figures as JSON: what one program draws another can draw."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import fields, is_dataclass
from typing import TYPE_CHECKING, Annotated, Any, Final

import numpy as np
from pydantic import PlainSerializer, PlainValidator

from catseye.app.results.figures import (
    Arrow,
    Axis,
    Band,
    Bars,
    Figure,
    Heat,
    Level,
    Line,
    Panel,
    Points,
    Role,
    Shape,
    Span,
    Stems,
    Text,
)

_KINDS: Final[dict[str, type[Any]]] = {
    kind.__name__.lower(): kind
    for kind in (Arrow, Axis, Band, Bars, Figure, Heat, Level, Line, Panel, Points, Shape, Span, Stems, Text)
}
_COLUMNS: Final = frozenset({"x", "y", "u", "area", "value", "low", "high", "edges", "height"})
"""Fields of marks that are arrays."""


def figures_json(figures: Iterable[Figure]) -> list[Any]:
    """Return figures as plain values: each part names its kind, what is not a number is null."""
    return [_plain(figure) for figure in figures]


def figures_of(document: Iterable[Any]) -> tuple[Figure, ...]:
    """Return the figures that `figures_json` wrote; figures stay what they are.

    Raises:
        ValueError: it is not what `figures_json` writes.
    """
    try:
        return tuple(one if isinstance(one, Figure) else _part(one) for one in document)
    except (KeyError, TypeError) as error:
        raise ValueError(f"no figure: {error}") from error


if TYPE_CHECKING:
    FigureParts = tuple[Figure, ...]
else:
    # Pydantic would look for the arrays of the marks, which are imported for type checkers only.
    FigureParts = Annotated[Any, PlainValidator(figures_of), PlainSerializer(figures_json)]


def _plain(value: Any) -> Any:
    if is_dataclass(value) and not isinstance(value, type):
        parts = {field.name: _plain(getattr(value, field.name)) for field in fields(value)}
        return {"kind": type(value).__name__.lower(), **parts}
    if isinstance(value, np.ndarray | np.generic):
        return _plain(value.tolist())
    if isinstance(value, list | tuple):
        return [_plain(one) for one in value]
    if isinstance(value, float):
        # More digits than any drawing shows.
        return float(f"{value:.7g}") if math.isfinite(value) else None
    return value


def _part(document: Mapping[str, Any]) -> Any:
    kind = _KINDS[document["kind"]]
    return kind(**{name: _value(kind, name, value) for name, value in document.items() if name != "kind"})


def _value(kind: type[Any], name: str, value: Any) -> Any:
    if isinstance(value, dict):
        return _part(value)
    if name == "ink":
        return value if isinstance(value, int) else Role(value)
    if isinstance(value, list):
        if name in _COLUMNS and kind not in {Axis, Panel, Figure}:
            return np.array(value, dtype=np.float64)
        return tuple(_value(kind, "", one) for one in value)
    return value
