"""Turning one joint before the instrument: what it sees at each place, and what that says of frames."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from catseye.calibration.serial_arm.axis_frames import AxisLine, frame_of_axes, nominal_axis
from catseye.calibration.serial_arm.circles import circle_of
from catseye.drivers.roles.errors import HiddenTargetError
from catseye.drivers.roles.pose import Pose
from catseye.drivers.roles.tracker import Place
from catseye.procedures.kit.context import Context
from catseye.procedures.kit.errors import HiddenTargetsError
from catseye.procedures.serial_arm.axis_turns import FEWEST, Turn
from catseye.procedures.serial_arm.bench import SerialBench
from catseye.procedures.serial_arm.records import target_record

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Turned:
    """What was seen of a turn.

    Attributes:
        command_deg: of the joint, shape (n,).
        place_mm: of the target in the instrument's frame, shape (n, 3).
        from_below: shape (n,).
        hidden: values at which the target was not seen.
    """

    command_deg: Floats
    place_mm: Floats
    from_below: NDArray[np.bool_]
    hidden: tuple[float, ...]


def near_mm(bench: SerialBench, base: Floats, pose: Pose, target: str) -> Place:
    """Return where a target of the nominal arm is looked for, in the instrument's frame.

    Args:
        base: of the arm in the instrument's frame, shape (4, 4).
    """
    flange = bench.workspace.chain.flange(np.array([pose]))[0]
    x, y, z = (base @ flange @ np.array([*bench.target(target).place_mm, 1.0]))[:3].tolist()
    return x, y, z


async def turned(ctx: Context, bench: SerialBench, turn: Turn, settle_s: float, dwell_s: float) -> Turned:
    """Turn a joint and measure its target at every place.

    Raises:
        HiddenTargetsError: the target was seen at too few places.
    """
    base = bench.instrument.base
    await ctx.move(turn.first)
    seen: list[tuple[float, Place, bool]] = []
    hidden: list[float] = []
    for number, (value, from_below) in enumerate(turn.order):
        if number == len(turn.values_deg):
            await ctx.move(turn.turning_back)
        pose = turn.pose(value)
        await ctx.move(pose)
        try:
            found = await ctx.measure_target(
                turn.target, settle_s, dwell_s, near_mm(bench, base, pose, turn.target)
            )
        except HiddenTargetError:
            hidden.append(value)
            continue
        name = f"{turn.name}/{'+' if from_below else '-'}/{value:g}"
        ctx.record(target_record(name, turn.target, found, (pose, await ctx.joints()), None))
        seen.append((value, found.place_mm, from_below))
    if len(seen) < FEWEST:
        raise HiddenTargetsError(
            f"{turn.name}: {turn.target} was seen at {len(seen)} of {len(turn.order)} places, and a circle needs "
            f"{FEWEST}: turn the nest to the instrument and clear the line of sight, then continue with catseye "
            "resume"
        )
    values, places, sides = zip(*seen, strict=True)
    return Turned(np.array(values), np.array(places), np.array(sides), tuple(hidden))


def frame_seen(bench: SerialBench, turns: tuple[Turn, Turn], seen: tuple[Turned, Turned]) -> Floats:
    """Return the base in the instrument's frame as two axes show it, shape (4, 4)."""
    chain = bench.workspace.chain
    lines = []
    for one in seen:
        circle = circle_of(one.command_deg, one.place_mm)
        lines.append(AxisLine(circle.centre_mm, circle.axis))
    nominal = [nominal_axis(chain, turn.joint, np.array(turn.standing)) for turn in turns]
    return frame_of_axes((nominal[0], nominal[1]), (lines[0], lines[1]))


def target_seen_mm(
    bench: SerialBench, turns: tuple[Turn, Turn], seen: tuple[Turned, Turned]
) -> tuple[float, float, float]:
    """Return a target in the frame of the flange as the two last axes show it: mean over the places of the first."""
    base = frame_seen(bench, turns, seen)
    poses = np.array([turns[0].pose(float(value)) for value in seen[0].command_deg])
    flange = base @ bench.workspace.chain.flange(poses)
    back = np.einsum("nji,nj->ni", flange[:, :3, :3], seen[0].place_mm - flange[:, :3, 3]).mean(axis=0)
    x, y, z = back.tolist()
    return x, y, z
