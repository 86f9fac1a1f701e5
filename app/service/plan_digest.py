"""A fingerprint of a plan: the same plan is made again, or it is not."""

import dataclasses
import hashlib
import json
from collections.abc import Mapping
from collections.abc import Set as AbstractSet
from typing import Any

import numpy as np
from pydantic import BaseModel

from catseye.procedures.kit.bench import Bench

_DECIMALS = 6
"""Of mm and deg: far below what an arm resolves, far above what another processor rounds differently."""


def plan_digest(plan: object) -> str:
    """Return the SHA-256 of everything that a plan holds, numbers rounded to a nanometre or a microdegree.

    The bench that a plan keeps beside what it decides is left out: it follows from the configuration, which a run
    stores, so that a program that describes a bench otherwise and plans the same goes on with the run.
    """
    text = json.dumps(_plain(plan), sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()


def _plain(value: Any) -> Any:
    match value:
        case None | bool() | int() | str():
            return value
        case float():
            # Adding zero makes one of the two zeros.
            return round(value, _DECIMALS) + 0.0
        case Bench():
            return value.name
        case BaseModel():
            return _plain(value.model_dump())
        case np.ndarray():
            return _plain(value.tolist())
        case np.generic():
            return _plain(value.item())
        case Mapping():
            return {str(key): _plain(item) for key, item in value.items()}
        case AbstractSet():
            return sorted(json.dumps(_plain(item), sort_keys=True) for item in value)
        case list() | tuple():
            return [_plain(item) for item in value]
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {field.name: _plain(getattr(value, field.name)) for field in dataclasses.fields(value)}
    # Nothing that is known of it survives the process: its kind has to do.
    return type(value).__qualname__
