"""Moves of a six-axis arm as a RAPID module and as a KRL module."""

from collections.abc import Sequence
from dataclasses import dataclass

from catseye.calibration.core.types import Floats


@dataclass(frozen=True)
class Move:
    """A move to joints.

    Attributes:
        name: as a controller takes it: letters, digits and underscores.
        joints: deg, shape (6,).
        remark: of the program, empty where there is nothing to say.
    """

    name: str
    joints: Floats
    remark: str = ""


def rapid_module(moves: Sequence[Move], header: Sequence[str]) -> str:
    """Return a RAPID module that makes the moves one after the other.

    Args:
        header: lines that say where they come from.
    """
    declared = [
        f"  CONST jointtarget {one.name}:=[[{_listed(one.joints)}],[9E9,9E9,9E9,9E9,9E9,9E9]];"
        for one in moves
    ]
    lines = ["MODULE CATSCOMP", *(f"  ! {line}" for line in header), *declared, "  PROC catscomp()"]
    for one in moves:
        lines += [f"    ! {one.remark}"] if one.remark else []
        lines.append(f"    MoveAbsJ {one.name}\\NoEOffs,v100,fine,tool0;")
    return "\r\n".join([*lines, "  ENDPROC", "ENDMODULE", ""])


def krl_module(moves: Sequence[Move], header: Sequence[str]) -> str:
    """Return a KRL module likewise."""
    lines = ["DEF CATSCOMP( )", "INT I", *(f"; {line}" for line in header)]
    lines += ["FOR I=1 TO 6", "   $VEL_AXIS[I]=10", "ENDFOR"]
    for one in moves:
        axes = ", ".join(f"A{k} {value:.6f}" for k, value in enumerate(one.joints, 1))
        lines += [f"; {one.name}: {one.remark}" if one.remark else f"; {one.name}", f"PTP {{{axes}}}"]
    return "\r\n".join([*lines, "END", ""])


def _listed(q: Floats) -> str:
    return ",".join(f"{value:.6f}" for value in q)
