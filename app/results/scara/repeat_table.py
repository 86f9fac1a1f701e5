"""Quantities after ISO 9283 of poses that a path attains several times."""

import numpy as np

from catseye.app.render.markup import Html, paragraphs, table
from catseye.app.results.numbers import fixd, plain
from catseye.app.results.scara.repeated_poses import repeated_poses
from catseye.app.results.scara.validation import PathValidation

_MOST = 40
"""Poses that a table lists."""


def repeat_table(validation: PathValidation) -> Html:
    """Return accuracy and repeatability of repeated poses; empty when none was attained twice."""
    path, model = validation.path, validation.models[-1]
    found = repeated_poses(path, model)
    if not found.rows:
        return Html()
    head = ["pose: X, Y / mm", "n", "AP / µm", "RP / µm", "AP to the model / µm"]
    rows = [
        [
            ", ".join(plain(round(float(value), 3)) for value in path.command_mm[row]),
            str(one.n),
            fixd(1e3 * one.accuracy, 1),
            fixd(1e3 * one.repeatability, 1),
            fixd(1e3 * float(off), 1),
        ]
        for row, one, off in zip(found.rows, found.poses, found.model_mm, strict=True)
    ]
    rp_um = [1e3 * one.repeatability for one in found.poses]
    counts = sorted({one.n for one in found.poses})
    told = (
        f"{len(rows)} poses were attained {counts[0]}{f' to {counts[-1]}' if len(counts) > 1 else ''} times (the "
        f"standard test has 30 cycles); RP {np.median(rp_um):.1f} µm in the median, {max(rp_um):.1f} µm at most. AP: "
        "pose accuracy, in the frame aligned to the last model; RP: pose repeatability, which holds the instrument's "
        "scatter too."
    )
    more = f" The first {_MOST} are listed." if len(rows) > _MOST else ""
    return Html(table("Repeated poses, quantities of ISO 9283", head, rows[:_MOST]) + paragraphs(told + more))
