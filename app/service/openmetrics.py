"""Values as OpenMetrics text, version 1.0: what Prometheus and its like read."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Final, Literal

_ESCAPES: Final = str.maketrans({"\\": r"\\", "\n": r"\n", '"': r"\""})


@dataclass(frozen=True)
class Sample:
    """A value and what sets it apart from the others of its family.

    Attributes:
        value: the number.
        labels: by name.
    """

    value: float
    labels: Mapping[str, str]


@dataclass(frozen=True)
class Family:
    """Values of one kind.

    Attributes:
        name: ends with the unit, if it has one.
        kind: how values follow each other.
        text: for people.
        samples: none where nothing is known.
        unit: of all samples, in words; empty for none.
    """

    name: str
    kind: Literal["gauge", "counter", "stateset"]
    text: str
    samples: tuple[Sample, ...]
    unit: str = ""


def exposition(families: Iterable[Family], common: Mapping[str, str]) -> str:
    """Return families as text; those without a value are left out.

    Args:
        common: labels of every sample.
    """
    lines = [line for family in families if family.samples for line in _lines(family, common)]
    return "\n".join([*lines, "# EOF\n"])


def _lines(family: Family, common: Mapping[str, str]) -> list[str]:
    unit = [f"# UNIT {family.name} {family.unit}"] if family.unit else []
    name = f"{family.name}_total" if family.kind == "counter" else family.name
    return [
        f"# TYPE {family.name} {family.kind}",
        *unit,
        f"# HELP {family.name} {family.text.translate(_ESCAPES)}",
        *(f"{name}{_labels({**common, **each.labels})} {_number(each.value)}" for each in family.samples),
    ]


def _labels(labels: Mapping[str, str]) -> str:
    inside = ",".join(f'{name}="{value.translate(_ESCAPES)}"' for name, value in labels.items())
    return f"{{{inside}}}" if inside else ""


def _number(value: float) -> str:
    if math.isinf(value):
        return "+Inf" if value > 0.0 else "-Inf"
    return "NaN" if math.isnan(value) else repr(value)
