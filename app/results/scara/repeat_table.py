"""Quantities after ISO 9283 of poses that a path attains several times."""

import numpy as np

from catseye.app.results.model import Block, Column, Paragraph, Table
from catseye.app.results.numbers import COUNT, PLAIN, fixed, number
from catseye.app.results.scara.repeated_poses import repeated_poses
from catseye.app.results.scara.validation import PathValidation

_MOST = 40
"""Poses that a table lists."""

_UM = fixed(1)
_COLUMNS = (
    Column("pose", "pose: X, Y", "mm"),
    Column("n", "n", format=COUNT),
    Column("ap_um", "AP", "µm", _UM),
    Column("rp_um", "RP", "µm", _UM),
    Column("ap_to_model_um", "AP to the model", "µm", _UM),
)


def repeat_blocks(validation: PathValidation) -> list[Block]:
    """Return accuracy and repeatability of repeated poses; nothing when none was attained twice."""
    path, model = validation.path, validation.models[-1]
    found = repeated_poses(path, model)
    if not found.rows:
        return []
    rows = [
        (
            ", ".join(number(round(float(value), 3), PLAIN) for value in path.command_mm[row]),
            pose.n,
            1e3 * pose.accuracy,
            1e3 * pose.repeatability,
            1e3 * float(off),
        )
        for row, pose, off in zip(found.rows, found.poses, found.model_mm, strict=True)
    ]
    rp_um = [1e3 * pose.repeatability for pose in found.poses]
    counts = sorted({pose.n for pose in found.poses})
    text = (
        f"{len(rows)} poses were attained {counts[0]}{f' to {counts[-1]}' if len(counts) > 1 else ''} times (the "
        f"standard test has 30 cycles); RP {np.median(rp_um):.1f} µm in the median, {max(rp_um):.1f} µm at most. AP: "
        "pose accuracy, in the frame aligned to the last model; RP: pose repeatability, which holds the instrument's "
        "scatter too."
    )
    more = f" The first {_MOST} are listed." if len(rows) > _MOST else ""
    table = Table("repeated_poses", "Repeated poses, quantities of ISO 9283", _COLUMNS, tuple(rows[:_MOST]))
    return [table, Paragraph(text + more)]
