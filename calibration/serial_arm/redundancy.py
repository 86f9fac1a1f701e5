"""Parameters that say the same: which are kept, which stay at their nominal values, and why.

Two axes that are parallel, a tool whose place is unknown, anchors that nobody has measured: each makes combinations
of parameters that no measurement shows. Of each such combination one parameter is held, by a stated order and not by
what rounding prefers.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.kinematics.chain import Chain
from catseye.calibration.serial_arm.parameters import (
    AnchorPlace,
    BaseFrame,
    Compliance,
    DeadPath,
    Harmonic,
    Link,
    MapNode,
    Parameter,
    Reversal,
    TargetPlace,
)

_NULL = 1e-8
"""A column of which the columns before it leave less than this share says nothing new."""

_STILL_MM = 1e-7
"""A parameter that moves the targets by less than this per mm or deg, rms, moves nothing: its column is rounding."""

_COMPLIANT = 1e-6
"""What stands for a unit of a compliance, rad/(N·mm): that of a soft strain wave gear."""

_PARTICIPATION = 1e-3
"""A parameter takes part in a null direction when its share, as motion, exceeds this."""


@dataclass(frozen=True)
class Choice:
    """Which parameters are estimated.

    Attributes:
        kept: their numbers, in the order of the parameters.
        held: numbers of those that the kept ones make superfluous.
        directions: of each held parameter, the names of all that take part in its null direction.
    """

    kept: Ints
    held: Ints
    directions: tuple[tuple[str, ...], ...]


def choose_basis(chain: Chain, parameters: Sequence[Parameter], jacobian: Floats) -> Choice:
    """Choose parameters that the rows tell apart.

    Kept first: links, compliances, anchors, dead paths, targets, base; then what the last joint shares with its tool;
    reversals and harmonics at last.

    Args:
        jacobian: derivatives of the residuals, mm per unit, shape (n, p).
    """
    order = sorted(range(len(parameters)), key=lambda k: (_rank(chain, parameters[k]), k))
    norms = np.linalg.norm(jacobian, axis=0)
    scaled = jacobian / np.where(norms > 0.0, norms, 1.0)
    sizes = np.array([_COMPLIANT if isinstance(one.role, Compliance) else 1.0 for one in parameters])
    moves = norms * sizes > _STILL_MM * np.sqrt(len(jacobian))
    basis = np.zeros((len(jacobian), 0))
    kept: list[int] = []
    held: dict[int, tuple[str, ...]] = {}
    for k in order:
        left = scaled[:, k] - basis @ (basis.T @ scaled[:, k])
        left -= basis @ (basis.T @ left)
        size = float(np.linalg.norm(left))
        if moves[k] and size > _NULL:
            basis = np.column_stack([basis, left / size])
            kept.append(k)
        else:
            held[k] = _involved(parameters, scaled, kept, k) if moves[k] else (parameters[k].name,)
    numbers = sorted(held)
    return Choice(
        np.array(sorted(kept), dtype=np.int64),
        np.array(numbers, dtype=np.int64),
        tuple(held[k] for k in numbers),
    )


def _involved(parameters: Sequence[Parameter], scaled: Floats, kept: list[int], k: int) -> tuple[str, ...]:
    share = np.abs(np.linalg.lstsq(scaled[:, kept], scaled[:, k], rcond=None)[0])
    others = [
        parameters[kept[j]].name for j in np.flatnonzero(share > _PARTICIPATION * share.max(initial=0.0))
    ]
    return (*others, parameters[k].name)


def _rank(chain: Chain, parameter: Parameter) -> int:
    match parameter.role:
        case Link(joint, "theta_offset_deg" | "d_mm") if joint == len(chain.joints) - 1:
            return 4
        case Link() | Compliance():
            return 0
        case AnchorPlace() | DeadPath():
            return 1
        case TargetPlace():
            return 2
        case BaseFrame():
            return 3
        case Reversal():
            return 5
        case Harmonic() | MapNode():
            return 6
