"""Quantities after ISO 230-2 of the joints' maps, as a section of a report."""

from collections.abc import Sequence

import numpy as np

from catseye.app.files.identified_arm import arm_of
from catseye.app.files.result_json import Result
from catseye.app.render.markup import Html, paragraphs, section, table
from catseye.app.results.numbers import decimals_for, fixd, plain, signd
from catseye.app.results.scara.joint_maps import ARCSEC_PER_MDEG, JointMap, joint_maps


def standards_section(result: Result | None) -> Html:
    """Return a table of the quantities of each joint; empty for a model without maps.

    Args:
        result: an error map.
    """
    if result is None or result.model != "error-map":
        return Html()
    maps = joint_maps(arm_of(result))
    return section(
        "standards", "Positioning quantities of the joints", *_tables(maps), paragraphs(*_notes(maps))
    )


def _tables(maps: Sequence[JointMap]) -> list[Html]:
    head = ["quantity", "", "mdeg", "u", "arcsec", "u", "expected excess / mdeg"]
    return [table(_caption(one), head, _rows(one), text_columns=2) for one in maps]


def _caption(one: JointMap) -> str:
    low, high = np.rad2deg(one.nodes_rad[[0, -1]])
    return (
        f"J{one.joint}: quantities of ISO 230-2 from the map's {one.nodes_rad.size} nodes, "
        f"{plain(float(low))}° … {plain(float(high))}°"
    )


def _rows(one: JointMap) -> list[list[str]]:
    found = one.quantities()
    decimals = decimals_for((quantity.u for quantity in found), fallback=2)
    return [
        [
            quantity.symbol,
            quantity.name,
            fixd(quantity.value, decimals),
            fixd(quantity.u, decimals),
            fixd(ARCSEC_PER_MDEG * quantity.value, decimals),
            fixd(ARCSEC_PER_MDEG * quantity.u, decimals),
            signd(quantity.excess, decimals),
        ]
        for quantity in found
    ]


def _notes(maps: Sequence[JointMap]) -> list[str]:
    notes = [
        "Reversal errors are those of upward minus downward approaches. u: standard uncertainty (k = 1), by draws "
        "from the covariance of the map. A largest difference grows with the noise of the values that it is taken "
        "from: the expected excess tells by how much on average; it is not taken off. Accuracy A and repeatability R "
        "need repeated approaches of each joint by itself; distances along a beam mix both joints, so they are not "
        "stated here."
    ]
    left_out = [name for one in maps for name in one.left_out]
    if left_out:
        notes.append(
            f"Not part of a joint's own quantities, as they depend on the other joint: {', '.join(left_out)}."
        )
    return notes
