"""A ballbar over a sphere: lengths by kinematics of a true arm, readings typed and from a file."""

import math
import re
from dataclasses import replace
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from catseye.app.engine.dry_run import DryRunContext
from catseye.app.errors import UsageError
from catseye.app.protocol.procedures import parse_params
from catseye.app.store.reader import RunReader
from catseye.calibration.kinematics.chain import Chain
from catseye.calibration.kinematics.gravity import Load
from catseye.procedures.kit.errors import OutOfReachError, PlanError
from catseye.procedures.kit.system import System
from catseye.procedures.serial_arm.ballbar import BallbarParams, BallbarTest
from catseye.procedures.serial_arm.ballbar_path import sphere_path
from catseye.procedures.serial_arm.ballbar_plan import BallbarPlan
from catseye.procedures.serial_arm.calibrated import calibrated
from tests.unit.procedures.serial_arm.benches import SIX, Room, carried_out
from tests.unit.procedures.six_axes import CHAIN

ERRORS = {"A2.theta_offset_deg": -89.9, "A3.a_mm": 270.3, "A5.alpha_deg": 89.95, "A4.d_mm": 302.2}
"""Parameters of the calibrated arm, in the model's names."""

RESULT: dict[str, Any] = {
    "format": "catseye-serial-arm/1",
    "parameters": [{"name": name, "value": value} for name, value in ERRORS.items()],
}
CUP = np.array([450.0, 0.0, 60.0])
BENCH = replace(SIX, ballbar=replace(SIX.ballbar, centre_mm=tuple(CUP.tolist())))  # type: ignore[type-var]  # it has one
SMALL: dict[str, Any] = {
    "nests": ["N1"],
    "azimuth_deg": [-20.0, 20.0],
    "elevation_deg": [50.0, 70.0],
    "step_deg": 20.0,
    "dwell_s": 0.3,
}


LINK = Load(2, 3.5, (100.0, 0.0, 0.0))
CENTRE_MM = (50.0, 25.0, 100.0)


def true_chain() -> Chain:
    joints = list(CHAIN.joints)
    for name, value in ERRORS.items():
        joint, part = name.split(".")
        number = int(joint[1:]) - 1
        joints[number] = replace(joints[number], **{part: value})  # type: ignore[arg-type]  # numbers of a joint
    return Chain(tuple(joints))


@cache
def plan_of(**changes: Any) -> BallbarPlan:
    return BallbarTest().plan(BENCH, BallbarParams(result=RESULT, **{**SMALL, **changes}))


def lengths(chain: Chain, commands: object) -> np.ndarray:
    flange = chain.flange(np.array(commands))
    nest = flange[:, :3, :3] @ np.array(SIX.target("N1").place_mm) + flange[:, :3, 3]
    return np.asarray(np.linalg.norm(nest - CUP, axis=1))


def test_the_calibrated_arm_holds_the_bar_at_its_length() -> None:
    (path,) = plan_of().paths
    assert lengths(true_chain(), path.commands) == pytest.approx(np.full(len(path.commands), 300.0), abs=1e-6)
    # The nominal arm would not, by far.
    assert np.abs(lengths(CHAIN, path.commands) - 300.0).max() > 0.2
    assert len(path.measured) == 6


def test_play_is_made_up_for_along_the_path() -> None:
    """The arm of the test lags by half of the play of two joints, on whichever side a command comes from."""
    play_deg = np.array([0.06, 0.0, 0.05, 0.0, 0.0, 0.0])
    loose = [{"name": f"A{k + 1}.reversal_deg", "value": -play_deg[k]} for k in (0, 2)]
    result = {**RESULT, "parameters": [*RESULT["parameters"], *loose]}
    (path,) = (plan := BallbarTest().plan(BENCH, BallbarParams(result=result, **SMALL))).paths
    commands = np.vstack([plan.rest, path.commands])
    stood = commands[1:].copy()
    came, seen = np.ones(6), []
    for k, step in enumerate(np.diff(commands, axis=0)):
        came = np.where(np.abs(step) > 1e-6, np.sign(step), came)
        stood[k] -= 0.5 * play_deg * came
        seen.append(came)
    assert (np.ptp(seen, axis=0)[[0, 2]] == 2.0).all()
    assert lengths(true_chain(), stood) == pytest.approx(np.full(len(stood), 300.0), abs=1e-6)
    assert np.abs(path.deviation_mm).max() < 1e-6


def test_between_commands_the_bar_stays_in_range() -> None:
    (path,) = plan_of().paths
    commands = np.array(path.commands)
    between = np.concatenate(
        [commands[:-1] + share * np.diff(commands, axis=0) for share in (0.25, 0.5, 0.75)]
    )
    assert np.abs(lengths(true_chain(), between) - 300.0).max() < 0.2


def test_a_bent_elbow_keeps_the_bar_near_the_sphere() -> None:
    aside = BallbarParams(result=RESULT, **{**SMALL, "azimuth_deg": [-90.0, -60.0]})
    (path,) = BallbarTest().plan(BENCH, aside).paths
    commands = np.array(path.commands)
    between = np.concatenate(
        [commands[:-1] + share * np.diff(commands, axis=0) for share in (0.25, 0.5, 0.75)]
    )
    assert np.abs(lengths(true_chain(), between) - 300.0).max() < 0.11
    assert len(path.measured) == 6


def test_neighbours_on_the_path_are_near() -> None:
    path = sphere_path([-20.0, 0.0, 20.0], [50.0, 70.0], 180.0)
    apart = [
        math.degrees(math.acos(min(1.0, float(one.direction @ other.direction))))
        for one, other in pairwise(path)
    ]
    assert max(apart) <= 2.5 + 1e-9
    measured = [one for one in path if one.measured]
    assert [one.azimuth_deg for one in measured] == pytest.approx([-20.0, 0.0, 20.0, 20.0, 0.0, -20.0])
    assert [one.elevation_deg for one in measured] == pytest.approx([50.0] * 3 + [70.0] * 3)


async def test_a_mistyped_reading_is_asked_for_again(tmp_path: Path) -> None:
    room = Room(tmp_path)
    room.answers = {f"reading/N1/{number:04d}": "0.1" for number in range(1, 7)}
    room.answers |= {"reading/N1/0002": "300.2", "reading/N1/0002/2": "0.2"}
    outcome = await carried_out(room, BallbarTest(), plan_of())
    assert outcome.status == "complete"
    assert [row["error_mm"] for row in RunReader(outcome.path).rows("ballbar")] == [
        0.1,
        0.2,
        0.1,
        0.1,
        0.1,
        0.1,
    ]


def test_a_bar_that_would_leave_its_range_is_refused() -> None:
    with pytest.raises(OutOfReachError, match=r"more than 0\.01 mm is safe"):
        plan_of(safe_mm=0.01)


def test_commands_of_frames_alone_are_no_compensation() -> None:
    frames = {**RESULT, "parameters": [{"name": "base.x_mm", "value": 1.0}]}
    with pytest.raises(PlanError, match="calibrated arm only"):
        BallbarTest().plan(BENCH, BallbarParams(result=frames, **SMALL))


FOUND_MM = tuple(value + by for value, by in zip(SIX.target("N1").place_mm, (0.3, 0.0, 0.3), strict=True))
"""Where N1 was identified on the flange."""

NEST_FOUND: dict[str, Any] = {
    **RESULT,
    "parameters": [
        *RESULT["parameters"],
        *({"name": f"N1.{axis}_mm", "value": value} for axis, value in zip("xyz", FOUND_MM, strict=True)),
    ],
}


def test_the_nest_is_led_from_where_it_was_identified() -> None:
    x, y, z = FOUND_MM
    (path,) = BallbarTest().plan(BENCH, BallbarParams(result=NEST_FOUND, **SMALL)).paths
    flange = true_chain().flange(np.array(path.commands))
    nest = flange[:, :3, :3] @ [x, y, z] + flange[:, :3, 3]
    assert np.linalg.norm(nest - CUP, axis=1) == pytest.approx(np.full(len(nest), 300.0), abs=1e-6)
    assert path.deviation_mm == pytest.approx(np.zeros(len(nest)), abs=1e-6)


def test_the_tool_weighs_what_it_weighed_when_it_was_identified() -> None:
    """As compensate has it: the compliances belong to these masses, whatever the cell's tool file says today."""

    def commands(of_cell_kg: float, tool: dict[str, Any] | None) -> np.ndarray:
        bench = replace(BENCH, loads=(LINK, Load(6, of_cell_kg, CENTRE_MM)))
        soft = [*RESULT["parameters"], {"name": "A2.compliance_rad_per_nmm", "value": 3.2e-8}]
        result = {**RESULT, "parameters": soft, **({} if tool is None else {"tool": tool})}
        (path,) = BallbarTest().plan(bench, BallbarParams(result=result, **SMALL)).paths
        return np.array(path.commands)

    then = {"mass_kg": 2.7, "centre_mm": list(CENTRE_MM)}
    np.testing.assert_array_equal(commands(0.5, then), commands(2.7, None))
    assert np.abs(commands(0.5, then) - commands(0.5, None)).max() > 1e-3
    # A result of targets without a tool's file knows no mass of it.
    weightless = {**RESULT, "tool": None}
    assert calibrated(replace(BENCH, loads=(LINK, Load(6, 2.7, CENTRE_MM))), weightless).arm.loads == (LINK,)


def test_the_links_weigh_what_they_weighed_when_it_was_identified() -> None:
    then = {"joint": "A3", "mass_kg": 4.2, "centre_mm": [140.0, 0.0, 0.0]}
    result = {**RESULT, "tool": None, "description": {"link": [then]}}
    assert calibrated(replace(BENCH, loads=(LINK, Load(6, 2.7, CENTRE_MM))), result).arm.loads == (
        Load(3, 4.2, (140.0, 0.0, 0.0)),
    )
    with pytest.raises(PlanError, match="its masses cannot be read"):
        calibrated(BENCH, {**result, "description": {"link": [{**then, "joint": "A9"}]}})


def test_a_result_with_a_parameter_twice_is_refused() -> None:
    twice = {**RESULT, "parameters": [*RESULT["parameters"], RESULT["parameters"][0]]}
    with pytest.raises(PlanError, match="stands twice"):
        calibrated(BENCH, twice)


def test_no_bar_is_led_by_joints_read_back() -> None:
    read = {**RESULT, "joints": "read back"}
    with pytest.raises(PlanError, match="does not know by how much the arm misses its commands"):
        BallbarTest().plan(BENCH, BallbarParams(result=read, **SMALL))


def test_a_cup_out_of_reach_is_named_with_its_place() -> None:
    far = replace(BENCH, ballbar=replace(BENCH.ballbar, centre_mm=(900.0, 0.0, 60.0)))  # type: ignore[type-var]  # it has one
    with pytest.raises(PlanError, match=r"azimuth .*centre_mm"):
        BallbarTest().plan(far, BallbarParams(result=RESULT, **SMALL))


def test_a_file_that_is_no_calibration_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "result.json"
    file.write_text('{"format": "catseye-result/1"}', encoding="utf-8")
    with pytest.raises(UsageError, match="is not a calibration of a serial arm"):
        parse_params(BallbarParams, [f'result="{file}"'])


@pytest.mark.parametrize("readings", ["typed", "file"])
async def test_a_rehearsal_leads_the_bar(readings: str) -> None:
    dry = DryRunContext(System(BENCH), pose=(0.0,) * 6, declared=BallbarTest.records)
    await BallbarTest().run(dry, plan_of(readings=readings))
    dry.require_clear_ways()
    assert len(dry.records) == 6


async def test_typed_readings_are_kept_with_their_errors(tmp_path: Path) -> None:
    room = Room(tmp_path)
    typed = [0.1, -0.2, 0.05, 0.0, 0.3, -0.1]
    room.answers = {f"reading/N1/{number:04d}": str(value) for number, value in enumerate(typed, 1)}
    outcome = await carried_out(room, BallbarTest(), plan_of())
    assert (outcome.status, outcome.text) == ("complete", "")
    rows = RunReader(outcome.path).rows("ballbar")
    assert [row["error_mm"] for row in rows] == typed
    assert [row["length_mm"] for row in rows] == pytest.approx([300.0 + value for value in typed])
    (said,) = (one for one in RunReader(outcome.path).events() if one.kind == "ballbar")
    assert said.data["mean_mm"] == pytest.approx(np.mean(typed))
    assert said.data["max_mm"] == pytest.approx(0.3)
    # n − 1 as in the report of the run.
    assert said.data["std_mm"] == pytest.approx((sum((one - 0.025) ** 2 for one in typed) / 5) ** 0.5)
    ids = [prompt.id for prompt in room.asked]
    assert ids[0] == "mount/N1/1"
    mount = room.asked[0].text
    # Between two commands the arm leaves the sphere by a part of a millimetre.
    largest_mm = plan_of().paths[0].largest_mm
    assert largest_mm > 0.01
    bound = re.search(r"it reads \+0\.00 mm here, and no more than ±(\d\.\d\d) mm", mount)
    assert bound is not None
    assert largest_mm <= float(bound[1]) < largest_mm + 0.01
    assert ids[-1].startswith("off/N1")


async def test_an_impossible_reading_ends_the_run(tmp_path: Path) -> None:
    room = Room(tmp_path)
    room.answers = dict.fromkeys(["reading/N1/0001", "reading/N1/0001/2", "reading/N1/0001/3"], "300.1")
    outcome = await carried_out(room, BallbarTest(), plan_of())
    assert outcome.status == "failed"
    assert "beyond the bar's range" in outcome.text


async def test_resumption_takes_the_bar_off_first(tmp_path: Path) -> None:
    room = Room(tmp_path)
    room.answers = {f"reading/N1/{number:04d}": "0.1" for number in range(1, 7)}
    room.answers["mount/N1/1"] = "stop"
    first = await carried_out(room, BallbarTest(), plan_of())
    assert first.status == "failed"
    again = Room(tmp_path)
    again.robot.pose = room.robot.pose
    again.answers = {f"reading/N1/{number:04d}": "0.1" for number in range(1, 7)}
    outcome = await carried_out(again, BallbarTest(), plan_of(), resume=first.path)
    assert outcome.status == "complete"
    ids = [prompt.id for prompt in again.asked if prompt.id.startswith(("bare", "mount", "reading"))]
    assert ids[:3] == ["bare/N1/1", "mount/N1/1", "reading/N1/0001"]
    assert len(RunReader(outcome.path).rows("ballbar")) == 6


@pytest.mark.parametrize("seen", [7, 8])
async def test_a_slow_recording_shows_its_plateaus(tmp_path: Path, seen: int) -> None:
    room, bar = Room(tmp_path), tmp_path / "bar.csv"
    levels = [0.1, -0.2, 0.05, 0.0, 0.3, -0.1]
    # 4 readings a second, 2 s at a place; the arm stops for half a second on its way.
    values = [value for level in levels for value in ([level] * seen + [9.0, 8.0, 8.0, 9.0])]
    rows = [f"{0.25 * number:.2f},{value}" for number, value in enumerate(values)]
    bar.write_text("\n".join(["t_s,deviation_mm", *rows]) + "\n", encoding="utf-8")
    room.answers = {"lengths/N1": str(bar)}
    outcome = await carried_out(room, BallbarTest(), plan_of(readings="file", dwell_s=2.0))
    assert (outcome.status, outcome.text) == ("complete", "")
    assert [row["error_mm"] for row in RunReader(outcome.path).rows("ballbar")] == pytest.approx(levels)


async def test_lengths_come_from_the_plateaus_of_a_file(tmp_path: Path) -> None:
    room = Room(tmp_path)
    levels = [0.1, -0.2, 0.05, 0.0, 0.3, -0.1]
    values = [value for level in levels for value in ([level] * 11 + [9.0])]
    rows = [f"{0.1 * number:.1f},{value}" for number, value in enumerate(values)]
    good, short = tmp_path / "bar.csv", tmp_path / "short.csv"
    good.write_text("\n".join(["t_s,deviation_mm", *rows]) + "\n", encoding="utf-8")
    short.write_text("\n".join(["t_s,deviation_mm", *rows[:30]]) + "\n", encoding="utf-8")
    room.answers = {"lengths/N1": str(short), "lengths/N1/2": str(good)}
    outcome = await carried_out(room, BallbarTest(), plan_of(readings="file"))
    assert (outcome.status, outcome.text) == ("complete", "")
    assert [row["error_mm"] for row in RunReader(outcome.path).rows("ballbar")] == pytest.approx(levels)
    assert any("plateaus" in str(one["text"]) for one in room.said("warning"))


async def test_a_bound_of_the_bar_is_never_nothing(tmp_path: Path) -> None:
    room, plan = Room(tmp_path), plan_of()
    exact = replace(plan, paths=tuple(replace(path, largest_mm=1e-7) for path in plan.paths))
    room.answers = {"mount/N1/1": "stop"}
    await carried_out(room, BallbarTest(), exact)
    assert "no more than ±0.01 mm" in room.asked[0].text
