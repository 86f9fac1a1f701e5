"""Values of a stage's document against their limits."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, TypeGuard

from catseye.app.campaign.model import Limit
from catseye.app.protocol.campaign_events import LimitVerdict

_ANY: Final = "*"
_U: Final = "u"
_VALUE: Final = "value"
_MOST_NAMED: Final = 12


@dataclass(frozen=True)
class _Found:
    """A value in a document.

    Attributes:
        place: where it stands.
        value: the number; None for null.
        u: its standard uncertainty; None where none stands beside it.
    """

    place: str
    value: float | None
    u: float | None

    def spare(self, limit: Limit) -> float:
        """Return by how much it passes; negative where it does not."""
        if self.value is None or (limit.guard_k > 0.0 and self.u is None):
            return -math.inf
        guard = limit.guard_k * (self.u or 0.0)
        return min(self.value - guard - limit.low, limit.high - self.value - guard)


def judged(limit: Limit, document: object) -> LimitVerdict:
    """Return whether every value that a limit names passes; the worst of them stands for all."""
    found = list(_found(document, limit.value.split("."), ()))
    if not found:
        return _verdict(limit, _Found(limit.value, None, None), met=False, text=_missing(limit, document))
    worst = min(found, key=lambda one: one.spare(limit))
    return _verdict(limit, worst, met=worst.spare(limit) >= 0.0, text=_text(limit, worst))


def _found(node: object, keys: Sequence[str], place: tuple[str, ...]) -> Iterator[_Found]:
    if not keys:
        yield from _number(node, ".".join(place))
        return
    for key, inner in _inside(node, keys[0]):
        yield from _found(inner, keys[1:], (*place, key))


def _inside(node: object, key: str) -> Iterator[tuple[str, object]]:
    """Yield what stands under a key, or at a place of a list, or under each."""
    if isinstance(node, Mapping):
        yield from node.items() if key == _ANY else [(key, node[key])] if key in node else []
    elif isinstance(node, list):
        places = range(len(node)) if key == _ANY else [int(key)] if key.isdecimal() else []
        yield from ((str(place), node[place]) for place in places if place < len(node))


def _number(node: object, place: str) -> Iterator[_Found]:
    """Yield a number, with the standard uncertainty that is stated beside it."""
    if isinstance(node, Mapping) and _VALUE in node:
        u = node.get(_U)
        for found in _number(node[_VALUE], place):
            yield _Found(place, found.value, u if _is_number(u) else None)
    elif node is None:
        yield _Found(place, None, None)
    elif _is_number(node):
        yield _Found(place, float(node), None)


def _is_number(node: object) -> TypeGuard[float]:
    return isinstance(node, int | float) and not isinstance(node, bool)


def _verdict(limit: Limit, found: _Found, *, met: bool, text: str) -> LimitVerdict:
    return LimitVerdict(
        value=found.place,
        found=found.value,
        u=found.u,
        min=limit.min,
        max=limit.max,
        guard_k=limit.guard_k,
        met=met,
        text=text,
    )


def _text(limit: Limit, found: _Found) -> str:
    if found.value is None:
        return f"{found.place} was not found: its limit is not met"
    u = "" if found.u is None else f" (u {found.u:.3g})"
    within = f"{found.place} = {found.value:.5g}{u}, limit {limit.text}"
    if limit.guard_k == 0.0:
        return within
    if found.u is None:
        return f"{within}: no uncertainty is stated, so {limit.guard_k:g} u to spare cannot be shown"
    return f"{within} with {limit.guard_k:g} u to spare"


def _missing(limit: Limit, document: object) -> str:
    named = list(_places(document, ()))
    there = ", ".join(named[:_MOST_NAMED]) + (" …" if len(named) > _MOST_NAMED else "")
    return f"there is no value {limit.value} in what this stage found; there are {there or 'none'}"


def _places(node: object, place: tuple[str, ...]) -> Iterator[str]:
    """Yield where the numbers of a document stand; of a list, and of names that only the data know, its star."""
    if isinstance(node, Mapping) and _VALUE not in node:
        for key, inner in node.items():
            yield from _places(inner, (*place, key))
    elif isinstance(node, list):
        seen: dict[str, None] = {}
        for inner in node:
            seen |= dict.fromkeys(_places(inner, (*place, _ANY)))
        yield from seen
    elif list(_number(node, "")):
        yield ".".join(place)
