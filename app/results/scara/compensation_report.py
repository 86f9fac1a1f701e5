"""What corrected commands say."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from catseye.app.results.document import Document
from catseye.app.results.model import Report, Sign, Statement, section
from catseye.app.results.numbers import MDEG_PER_RAD, counted, fixed
from catseye.app.results.origin import origin_now
from catseye.app.results.scara.compensation import CompensatedPath
from catseye.app.results.scara.path_range import lines_text
from catseye.app.results.summary import Line, summary_table

_LARGE_DEG = 0.2
"""No joint of a sound arm needs such a correction; a stretched arm pays for its reach with it."""

_FIGURE = fixed(1)


def compensation_report(path: CompensatedPath, warnings: list[str]) -> Report:
    """Return warnings and a summary of corrected commands."""
    figures = compensation_figures(path)
    lines = (
        Line("rows corrected", "", f"{figures['corrected']} of {figures['rows']}"),
        Line("largest correction of J1", "mdeg", figures["largest_correction1_mdeg"], _FIGURE),
        Line("largest correction of J2", "mdeg", figures["largest_correction2_mdeg"], _FIGURE),
        Line("correction in the plane, rms", "µm", figures["rms_shift_um"], _FIGURE),
        Line("correction in the plane, largest", "µm", figures["largest_shift_um"], _FIGURE),
        Line("U left (k = 2), 2-D median", "µm", figures["median_u_um"], _FIGURE, standard=True),
        Line("left by steps of 1 mdeg, largest", "µm", figures["largest_rounding_um"], _FIGURE),
        Line("rows that need a take-up", "", figures["take_ups"]),
    )
    statements = [Statement(Sign.ATTENTION, f"{text}.") for text in warnings]
    table = summary_table("corrected commands", lines)
    return Report(
        "Compensation",
        origin_now(),
        (
            section("advice", "Advice", statements, brief=True),
            section("summary", "Summary", [table], brief=True),
        ),
    )


class CompensationDocument(Document):
    """Corrected commands of a path.

    Attributes:
        output: files.
        form: name of their format.
        rows: of the path.
        corrected: rows that have a correction.
        rms_shift_um: distance between given and corrected command.
        largest_shift_um: of the same.
        median_u_um: standard uncertainty of where the corrected arm stands, 2-D.
        largest_rounding_um: by the digits of the written commands.
        take_ups: rows before which play is taken up.
        warnings: what to know about it.
    """

    output: list[str]
    form: str
    rows: int
    corrected: int
    largest_correction1_mdeg: float
    largest_correction2_mdeg: float
    rms_shift_um: float
    largest_shift_um: float
    median_u_um: float
    largest_rounding_um: float
    take_ups: int
    warnings: list[str]


def compensation_document(
    path: CompensatedPath, output: Path, form: str, warnings: Sequence[str]
) -> CompensationDocument:
    """Return a compensated path as JSON has it."""
    fields = {"output": [str(output)], "form": form, **compensation_figures(path), "warnings": list(warnings)}
    return CompensationDocument.model_validate(fields)


def compensation_figures(path: CompensatedPath) -> dict[str, float]:
    """Return counts of rows and sizes of corrections by the names of the JSON output."""
    solved = path.solution.solved
    correction_mdeg = MDEG_PER_RAD * np.abs(path.correction_rad[solved])
    shift_um = 1e3 * np.hypot(*path.shift_mm[solved].T)
    u_um = 1e3 * np.hypot(*path.solution.u_mm[solved].T)
    rounding_um = 1e3 * path.rounding_mm[solved]
    return {
        "rows": int(solved.size),
        "corrected": int(solved.sum()),
        "largest_correction1_mdeg": float(correction_mdeg[:, 0].max()),
        "largest_correction2_mdeg": float(correction_mdeg[:, 1].max()),
        "rms_shift_um": float(np.sqrt(np.mean(shift_um**2))),
        "largest_shift_um": float(shift_um.max()),
        "median_u_um": float(np.median(u_um)),
        "largest_rounding_um": float(np.nanmax(rounding_um)),
        "take_ups": int(path.take_up.any(axis=1).sum()),
    }


def unsolved_text(path: CompensatedPath, lines: Sequence[int]) -> str:
    """Return which rows have no correction, and why; empty where all have one."""
    solution = path.solution
    far, beyond = ~solution.reachable, solution.reachable & ~solution.inside
    parts = []
    if far.any():
        parts.append(f"the identified arm does not reach the positions of {lines_text(lines, far)}")
    if beyond.any():
        parts.append(
            f"the corrected commands of {lines_text(lines, beyond)} lie outside the nodes of the maps, which are "
            "never extrapolated: identify with nodes that enclose them"
        )
    return "; ".join(parts)


def advice(path: CompensatedPath, lines: Sequence[int]) -> list[str]:
    """Return what has to be known about rows before they are driven."""
    texts = []
    loose = path.loose_mm > 0.0
    if loose.any():
        texts.append(
            f"{counted(int(loose.sum()), 'row')} ({lines_text(lines, loose)}) begin or reverse the motion of a joint "
            "and need a take-up (columns take_up1, take_up2): without it the arm may stand up to "
            f"{1e3 * np.nanmax(path.loose_mm):.0f} µm off"
        )
    against = np.logical_or(path.contradicted[:, 0], path.contradicted[:, 1])
    if against.any():
        texts.append(
            f"in {lines_text(lines, against)} the step to the row goes against the side from which it has to be "
            "approached: only a take-up gets there from that side"
        )
    large = np.any(np.abs(np.rad2deg(path.correction_rad)) > _LARGE_DEG, axis=1)
    if large.any():
        texts.append(
            f"in {lines_text(lines, large)} a joint is corrected by more than {_LARGE_DEG:g}°: the arm is nearly "
            "stretched or folded there, where little reach takes much of its angles; keep away from it"
        )
    return texts
