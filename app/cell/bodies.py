"""Bodies and boxes of a cell file as procedures need them, and which of their dimensions are only estimates."""

from collections.abc import Sequence
from dataclasses import replace

from catseye.app.cell.arm import ArmDescription, Body, arm_description
from catseye.app.cell.model import Cell
from catseye.app.cell.serial_arm import chain_of, point_of
from catseye.app.cell.workspace import Box as BoxSection
from catseye.calibration.kinematics.bodies import Box, Capsule
from catseye.calibration.kinematics.chain import Chain
from catseye.procedures.kit.bench import Workspace


def workspace_of(cell: Cell) -> Workspace:
    """Return the bodies of a cell's arm and what is around it; a body of the cell file replaces the arm's own."""
    description, given = arm_description(cell.robot.arm), cell.workspace
    chain = _chain(description, cell)
    own = {body.name: body for body in cell.body}
    bodies = [own.pop(body.name, body) for body in description.body]
    bodies += own.values()
    return Workspace(
        chain=chain,
        bodies=capsules_of(bodies, chain),
        table_z_mm=given.table.z_mm,
        stand_radius_mm=given.stands.radius_mm,
        clearance_mm=given.clearance_mm,
        keep_out=_boxes(given.keep_out),
        keep_in=_boxes(given.keep_in),
        unconfirmed=tuple(_unconfirmed(cell, bodies, chain)),
    )


def _chain(description: ArmDescription, cell: Cell) -> Chain:
    """Return the arm's joints with the lengths of the cell file, which are those of the arm on the bench."""
    a_mm, flange_z_mm = cell.robot.nominal_a_mm, cell.workspace.flange.z_mm
    return Chain(
        tuple(
            replace(
                joint,
                a_mm=a_mm.get(joint.name, joint.a_mm),
                d_mm=joint.d_mm if flange_z_mm is None or joint.kind == "revolute" else flange_z_mm,
            )
            for joint in chain_of(description).joints
        )
    )


def capsules_of(bodies: Sequence[Body], chain: Chain) -> tuple[Capsule, ...]:
    """Return bodies on the frames of their joints."""
    return tuple(
        Capsule(
            body.name,
            chain.frame_of(body.joint),
            point_of(body.from_mm),
            point_of(body.to_mm),
            body.radius_mm,
        )
        for body in bodies
    )


def _boxes(boxes: list[BoxSection]) -> tuple[Box, ...]:
    return tuple(Box(box.name, point_of(box.min_mm), point_of(box.max_mm)) for box in boxes)


def _unconfirmed(cell: Cell, bodies: list[Body], chain: Chain) -> list[str]:
    given = cell.workspace
    found = [
        f"{body.name} ({body.joint}: radius {body.radius_mm:g} mm, {_text(body.from_mm)} to {_text(body.to_mm)} mm)"
        for body in bodies
        if not body.confirmed
    ]
    sliding = [joint for joint in chain.joints if joint.kind == "prismatic"]
    stated = (
        (given.table.confirmed, f"table (z {given.table.z_mm:g} mm)"),
        (given.stands.confirmed, f"stands of the reflectors (radius {given.stands.radius_mm:g} mm)"),
        *((given.flange.confirmed, f"flange at {joint.name} = 0 (z {joint.d_mm:g} mm)") for joint in sliding),
    )
    return found + [text for confirmed, text in stated if not confirmed]


def _text(values: list[float]) -> str:
    return f"({', '.join(f'{value:g}' for value in values)})"
