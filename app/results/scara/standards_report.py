"""Quantities after ISO 230-2 of the joints' maps."""

from collections.abc import Sequence

import numpy as np

from catseye.app.results.model import Column, Paragraph, Section, Table, section
from catseye.app.results.numbers import PLAIN, decimals_for, fixed, number
from catseye.app.results.scara.identified_arm import arm_of
from catseye.app.results.scara.joint_maps import ARCSEC_PER_MDEG, JointMap, joint_maps
from catseye.app.results.scara.result import Result


def standards_section(result: Result | None) -> Section:
    """Return a table of the quantities of each joint; empty for a model without maps."""
    maps = () if result is None or result.model != "error-map" else joint_maps(arm_of(result))
    blocks = [*map(_table, maps), *(map(Paragraph, _notes(maps)) if maps else ())]
    return section("standards", "Positioning quantities of the joints", blocks, brief=True)


def _table(joint_map: JointMap) -> Table:
    low, high = (number(float(end), PLAIN) for end in np.rad2deg(joint_map.nodes_rad[[0, -1]]))
    quantities = joint_map.quantities()
    decimals = decimals_for((quantity.u for quantity in quantities), fallback=2)
    form, changed = fixed(decimals), fixed(decimals, signed=True)
    return Table(
        f"iso230_2_{joint_map.joint}",
        f"J{joint_map.joint}: quantities of ISO 230-2 from the map's {joint_map.nodes_rad.size} nodes, "
        f"{low}° … {high}°",
        (
            Column("symbol", "quantity"),
            Column("name", ""),
            Column("value_mdeg", "mdeg", format=form),
            Column("u_mdeg", "U", format=form, standard=True),
            Column("value_arcsec", "arcsec", format=form),
            Column("u_arcsec", "U", format=form, standard=True),
            Column("excess_mdeg", "expected excess", "mdeg", changed),
        ),
        tuple(
            (
                quantity.symbol,
                quantity.name,
                quantity.value,
                quantity.u,
                ARCSEC_PER_MDEG * quantity.value,
                ARCSEC_PER_MDEG * quantity.u,
                quantity.excess,
            )
            for quantity in quantities
        ),
    )


def _notes(maps: Sequence[JointMap]) -> list[str]:
    notes = [
        "Reversal errors: positive direction of approach minus negative. U: expanded uncertainty (k = 2), by draws "
        "from the covariance of the map. A largest difference grows with the noise of the values that it is taken "
        "from: the expected excess says by how much on average; it is not taken off. Accuracy A and repeatability R "
        "need repeated approaches of each joint by itself; distances along a beam mix both joints, so they are not "
        "stated here."
    ]
    left_out = [name for joint_map in maps for name in joint_map.left_out]
    if left_out:
        notes.append(
            f"Not part of a joint's own quantities, as they depend on the other joint: {', '.join(left_out)}."
        )
    return notes
