"""The emulated bench of a cell file with a serial arm."""

from dataclasses import replace
from pathlib import Path

from catseye.app.cell.arm import ArmDescription, Joint, arm_description
from catseye.app.cell.model import Cell
from catseye.app.cell.serial_arm import chain_of, loads_of, point_of
from catseye.app.cell.tool import ToolDescription
from catseye.app.files.documents import read_document
from catseye.app.service.emulation import control_endpoint, emulated_devices
from catseye.simulators.config import (
    ArmOptics,
    EmulationConfig,
    SerialArm,
    SerialBody,
    SerialJoint,
    SerialLoad,
    TruthText,
)
from catseye.simulators.survey import Mark, SurveyConfig


def serial_emulation_config(cell: Cell, speed: float, seed: int, truth: Path | None) -> EmulationConfig:
    """Return the emulated bench of a cell file; its arm stands in the middle of its ranges.

    Args:
        cell: the arm, and where the devices answer.
        speed: bench seconds in one real second.
        seed: of everything random.
        truth: JSON with the true arm; None draws one.

    Raises:
        ConfigError: an endpoint cannot be emulated, or the file with the tool or the true arm cannot be read.
    """
    tool = cell.robot.carried
    arm = serial_arm_of(arm_description(cell.robot.arm), tool)
    return EmulationConfig(
        serial=arm,
        limits=tuple((joint.low, joint.high) for joint in arm.joints),
        start_joints=tuple(0.5 * (joint.low + joint.high) for joint in arm.joints),
        devices=emulated_devices(cell),
        control=control_endpoint(cell),
        speed=speed,
        seed=seed,
        arm_optics=_optics(cell, tool),
        survey=_survey(cell, tool),
        truth=None if truth is None else TruthText(read_document(truth), str(truth)),
    )


def serial_arm_of(description: ArmDescription, tool: ToolDescription | None = None) -> SerialArm:
    """Return an arm with its tool as the emulation takes it."""
    loads = tuple(
        SerialLoad(load.frame, load.mass_kg, load.centre_mm) for load in loads_of(description, tool)
    )
    chain = chain_of(description)
    bodies = tuple(
        SerialBody(chain.frame_of(body.joint), point_of(body.from_mm), point_of(body.to_mm), body.radius_mm)
        for body in description.body
    )
    return SerialArm(description.name, tuple(map(_joint, description.joint)), loads, bodies)


def _survey(cell: Cell, tool: ToolDescription | None) -> SurveyConfig:
    """Return what instruments see: they and their nests stand about where the cell file says."""
    survey, tracker = SurveyConfig(targets=_targets(tool)), cell.tracker
    if bar := cell.ballbar:
        centre = point_of(bar.centre_mm)
        survey = replace(survey, cup=centre, ballbar_mm=bar.length_mm, ballbar_range_mm=bar.range_mm)
    if tracker is None or tracker.base_mm is None or tracker.base_deg is None:
        return survey
    nests = tuple(Mark(nest.name, (nest.x_mm, nest.y_mm, nest.z_mm)) for nest in tracker.nest)
    base = point_of(tracker.base_mm), point_of(tracker.base_deg)
    return replace(survey, nests=nests, base_seen=base, cone_deg=tracker.cone_deg)


def _targets(tool: ToolDescription | None) -> tuple[Mark, ...]:
    """Return the nests of a tool as the emulation takes them."""
    return tuple(
        Mark(one.name, (one.x_mm, one.y_mm, one.z_mm), None if one.normal is None else point_of(one.normal))
        for one in (() if tool is None else tool.target)
    )


def _optics(cell: Cell, tool: ToolDescription | None) -> ArmOptics:
    """Return the optics of a cell; the linear retroreflector sits at the tool's first target, or on the flange."""
    optics = ArmOptics()
    if cell.angular_optics is not None:
        angular = cell.angular_optics
        optics = replace(optics, spacing_mm=angular.spacing_mm, u_spacing_mm=angular.u_spacing_mm)
    if cell.linear_optics is not None:
        optics = replace(optics, distance_mm=cell.linear_optics.distance_mm)
    if tool is not None and tool.target:
        optics = replace(optics, target_mm=tool.place_mm(tool.target[0].name))
    return optics


def _joint(joint: Joint) -> SerialJoint:
    low, high = joint.range
    described = SerialJoint(
        name=joint.name,
        prismatic=joint.type == "prismatic",
        alpha_deg=joint.alpha_deg,
        a_mm=joint.a_mm,
        theta_offset_deg=joint.theta_offset_deg,
        d_mm=joint.d_mm,
        sign=joint.sign,
        low=low,
        high=high,
        speed=joint.speed,
        gear_ratio=joint.gear_ratio,
        encoder_bits=joint.encoder_bits,
    )
    stated = joint.acceleration
    return described if stated is None else replace(described, acceleration=stated)
