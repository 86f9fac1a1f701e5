"""A procedure without instruments."""

import math
from dataclasses import replace

import numpy as np
import pytest

from catseye.app.engine.driven import sampled, speeds_of
from catseye.app.engine.dry_run import DryRunContext
from catseye.app.errors import LimitError, MeasurementRejectedError
from catseye.drivers.roles.pose import Pose
from catseye.drivers.roles.robot import Following
from catseye.drivers.roles.tracker import Position
from catseye.procedures.kit.bench import Arm
from catseye.procedures.kit.columns import Columns
from catseye.procedures.kit.context import Context, Prompt
from catseye.procedures.kit.records import Row
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.ideal import ScaraBeam
from catseye.procedures.scara.path.tables import MEASURED
from catseye.procedures.scara.records import Distance
from catseye.procedures.scara.system import ScaraSystem
from tests.unit.app.engine.fakes import HOME, distance
from tests.unit.procedures.benches import bench, scara_axes

ARM = Arm(
    scara_axes(j3_mm=(-10.0, 10.0), speeds=(100.0,) * 3, accelerations=(200.0,) * 3),
    ("", "", "", ""),
    override_percent=50.0,
    follow_speed_deg_s=10.0,
    follow_acceleration_deg_s2=math.pi * 50.0,
)
BENCH = replace(bench(places={"P1": (650.0, 0.0), "P2": (0.0, 900.0)}), arm=ARM, j3_mm=0.0)


def dry_run(of: ScaraBench = BENCH) -> DryRunContext:
    return DryRunContext(ScaraSystem(of), HOME, declared=[Distance])


@pytest.fixture
def dry() -> DryRunContext:
    return dry_run()


def following(way: Following) -> ScaraBench:
    return replace(BENCH, arm=replace(ARM, following=way))


def length_mm(pose: Pose) -> float | None:
    hit = ScaraBeam(BENCH).hit(pose)
    return None if hit is None else hit.length_mm


@pytest.mark.parametrize(
    ("way", "duration_s"),
    # Twice 50 deg at 50 deg/s with ramps of a quarter of a second; once 100 deg; led at 10 deg/s, ramps of a tenth.
    [("stops", 2.5), ("blended", 2.25), ("streamed", 10.1)],
)
async def test_path_time_follows_the_arms_way_of_following(way: Following, duration_s: float) -> None:
    dry = dry_run(following(way))
    await dry.follow(((50.0, 0.0, 0.0, 0.0), (100.0, 0.0, 0.0, 0.0)))
    assert dry.total_s == pytest.approx(duration_s)
    assert dry.pose == (100.0, 0.0, 0.0, 0.0)
    with pytest.raises(LimitError, match="J2"):
        await dry.follow(((50.0, 0.0, 0.0, 0.0), (50.0, 150.0, 0.0, 0.0)))


@pytest.mark.parametrize(
    ("way", "cut"), [("stops", ()), ("blended", (25.0, 25.0, 0.0, 0.0)), ("streamed", ())]
)
async def test_motions_say_where_corners_are_cut(way: Following, cut: Pose) -> None:
    dry = dry_run(following(way))
    await dry.follow(((50.0, 0.0, 0.0, 0.0), (50.0, 50.0, 0.0, 0.0)))
    assert [leg.cut for leg in dry.motions] == [cut] * 2


def test_the_ideal_beam_returns_from_the_reflector_that_it_hits() -> None:
    assert length_mm((0.0, 0.0, 0.0, 0.0)) == pytest.approx(100.0)
    assert length_mm((90.0, 0.0, 0.0, 0.0)) == pytest.approx(350.0)
    assert length_mm((0.0, 0.0, 0.0, 180.0)) is None
    # 100.1 mm away at most: 1.001 mm aside misses by more than 1 mm even along the slanting beam.
    assert length_mm((0.0, 0.0, 0.0, math.degrees(1.001 / 100.0))) is None
    # The length is counted along the beam: by the cosine shorter.
    assert length_mm((0.0, 0.0, 0.0, math.degrees(0.999 / 100.0))) == pytest.approx(math.sqrt(1e4 - 0.999**2))


async def test_a_rehearsed_beam_leaves_as_it_is_mounted(dry: DryRunContext) -> None:
    await dry.zero(100.0)
    assert (await dry.beam()).beam_ok
    await dry.remounted(180.0)
    assert not (await dry.beam()).beam_ok
    await dry.move((0.0, 0.0, 0.0, 180.0))
    assert (await dry.beam()).beam_ok
    await dry.remounted(0.0)
    assert not (await dry.beam()).beam_ok


def test_the_beam_returns_only_at_the_cell_files_height() -> None:
    assert length_mm((0.0, 0.0, 0.99, 0.0)) == pytest.approx(100.0)
    assert length_mm((0.0, 0.0, -1.01, 0.0)) is None
    assert length_mm((0.0, 0.0, 0.8, math.degrees(0.8 / 100.0))) is None


def test_the_column_and_the_reflectors_field_hide_it() -> None:
    # From (-550, 0) the beam to P1 passes through the J1 axis.
    assert length_mm((180.0, 0.0, 0.0, 180.0)) is None
    turned = replace(BENCH, reflectors=(replace(BENCH.reflectors[0], facing_deg=95.0),))
    assert ScaraBeam(turned).hit(HOME) is None
    turned = replace(BENCH, reflectors=(replace(BENCH.reflectors[0], facing_deg=105.0),))
    assert ScaraBeam(turned).hit(HOME) is not None


def test_sampled_poses_are_dense_and_include_each_target() -> None:
    poses = sampled(HOME, [(2.5, -1.0, 0.0, 0.0), (2.5, -1.0, 10.0, 0.0)])
    assert float(np.abs(np.diff(poses, axis=0)).max()) <= 0.25 + 1e-9
    assert poses[0].tolist() == list(HOME)
    assert poses[(len(poses) - 1) // 2] == pytest.approx([2.5, -1.0, 0.0, 0.0])
    assert poses[-1] == pytest.approx([2.5, -1.0, 10.0, 0.0])


@pytest.mark.parametrize(
    ("way", "joint_deg_s", "tool_mm_s"),
    [
        # 2 deg at 200 deg/s² reach sqrt(2·200) = 20 deg/s; a straight arm of 550 mm turns about J1.
        ("stops", 20.0, 550.0 * math.radians(20.0)),
        # The whole way of 4 deg is one motion.
        ("blended", math.sqrt(800.0), 550.0 * math.radians(math.sqrt(800.0))),
        ("streamed", 10.0, 550.0 * math.radians(10.0)),
    ],
)
async def test_speeds_are_the_fastest_joints_and_the_tools(
    way: Following, joint_deg_s: float, tool_mm_s: float
) -> None:
    speeds = speeds_of(ScaraSystem(following(way)), HOME, [(2.0, 0.0, 0.0, 0.0), (4.0, 0.0, 0.0, 0.0)])
    assert speeds.joint_deg_s == pytest.approx(joint_deg_s)
    assert speeds.tool_mm_s == pytest.approx(tool_mm_s, rel=1e-4)
    # A long move runs at the override's share of the full speed.
    assert speeds_of(ScaraSystem(BENCH), HOME, [(100.0, 5.0, 0.0, 0.0)]).joint_deg_s == pytest.approx(50.0)
    assert speeds_of(ScaraSystem(BENCH), HOME, [HOME]).joint_deg_s == 0.0


async def test_a_paths_miss_counts_only_with_a_measured_distance(dry: DryRunContext) -> None:
    async def tracked() -> Row:
        await dry.zero(100.0)
        await dry.move((1.0, 0.0, 0.0, 0.0))
        await dry.measure(0.5, 0.5, 1)
        return {}

    async def anew() -> Row:
        await dry.move((90.0, 0.0, 0.0, 0.0))
        await dry.zero(350.0)
        await dry.measure(0.5, 0.5, 1)
        return {}

    await dry.step("tracked", "beam kept", tracked)
    await dry.step("anew", "beam zeroed at the end", anew)
    # At 1 deg the beam runs from the J1 axis outwards at 1 deg and passes (650, 0) at 650·sin 1°.
    assert dry.steps[0].miss_mm == pytest.approx(650.0 * math.sin(math.radians(1.0)))
    assert dry.steps[0].beam_mm is None
    assert dry.steps[1].miss_mm is None
    assert dry.steps[1].beam_mm == pytest.approx(350.0)
    assert dry.excess == [dry.steps[0]]


async def test_turning_j4_alone_can_lose_the_beam_without_a_miss(dry: DryRunContext) -> None:
    async def turn() -> Row:
        await dry.zero(100.0)
        for j4_deg in (0.3, -0.3, 0.0):
            await dry.move((0.0, 0.0, 0.0, j4_deg))
            assert (await dry.measure(0.5, 0.5, 1)).beam.count_valid
        await dry.move((0.0, 0.0, 0.0, 0.8))
        await dry.move(HOME)
        assert (await dry.beam()).beam_lost
        return {}

    await dry.step("turn", "J4 inside the return window", turn)
    assert (dry.steps[0].miss_mm, dry.excess) == (None, [])


async def test_heights_are_checked_too() -> None:
    low = dry_run(replace(BENCH, arm=replace(ARM, axes=scara_axes(j3_mm=(-1.0, 1.0)))))
    with pytest.raises(LimitError, match=r"J3 = 5 mm is outside -1 … 1 mm"):
        await low.move((0.0, 0.0, 5.0, 0.0))


async def test_questions_without_end_are_reported(dry: DryRunContext) -> None:
    async def ask(number: int) -> str:
        return await dry.ask(Prompt(f"again/{number}", "choice", "?", choices=("again", "stop")))

    assert {await ask(number) for number in range(50)} == {"again"}
    with pytest.raises(MeasurementRejectedError, match="is asked 'again/50'"):
        await ask(50)


async def test_a_pause_takes_its_time(dry: DryRunContext) -> None:
    await dry.pause(2.0)
    assert dry.total_s == pytest.approx(2.0)


async def test_a_file_holds_what_a_rehearsal_goes_on_with(dry: DryRunContext) -> None:
    rehearsed = Columns({"x_mm": np.array([550.0])}, np.array([2]))
    assert await dry.read_table("anything.csv", MEASURED, rehearsed) is rehearsed


async def test_it_gives_a_step_table_and_the_time(dry: DryRunContext) -> None:
    async def action() -> Row:
        await dry.move((100.0, 0.0, 0.0, 0.0))
        await dry.measure(0.5, 0.5, 5)
        dry.record(distance())
        return {"done": True}

    context: Context = dry
    assert await context.step("s1", "first", action) == {"done": True}
    (step,) = dry.steps
    assert (step.moves, step.measurements, step.end) == (1, 1, (100.0, 0.0, 0.0, 0.0))
    assert step.duration_s == pytest.approx(3.25)
    assert dry.total_s == pytest.approx(3.25)
    assert dry.records == [distance()]


async def test_a_step_names_the_end_of_its_first_motion(dry: DryRunContext) -> None:
    async def scan() -> Row:
        await dry.follow(((10.0, 0.0, 0.0, 0.0), (20.0, 0.0, 0.0, 0.0)))
        await dry.move((30.0, 0.0, 0.0, 0.0))
        return {}

    async def compute() -> Row:
        return {}

    await dry.step("s1", "scan", scan)
    await dry.step("s2", "compute", compute)
    assert [step.first for step in dry.steps] == [(20.0, 0.0, 0.0, 0.0), None]


async def test_limits_hold_at_every_move(dry: DryRunContext) -> None:
    with pytest.raises(LimitError, match="J2"):
        await dry.move((0.0, 150.0, 0.0, 0.0))


async def test_the_displacement_is_relative_to_the_zero(dry: DryRunContext) -> None:
    await dry.zero(500.0)
    measured = await dry.measure(0.5, 0.5, 1)
    assert (measured.displacement_mm, measured.beam.count_valid, measured.reported) == (0.0, True, HOME)
    assert dry.total_s == pytest.approx(0.5)


async def test_a_beam_broken_on_the_path_stays_lost_until_zeroed(dry: DryRunContext) -> None:
    await dry.zero(500.0)
    await dry.move((0.0, 0.0, 0.0, 5.0))
    await dry.move(HOME)
    assert not (await dry.measure(0.5, 0.5, 1)).beam.count_valid
    await dry.zero(500.0)
    assert (await dry.measure(0.5, 0.5, 1)).beam.count_valid


@pytest.mark.parametrize(
    ("prompt", "answer"),
    [
        (Prompt("a", "confirm", "?"), "yes"),
        (Prompt("b", "confirm", "?", safe_answer="no"), "yes"),
        (Prompt("c", "choice", "?", choices=("red", "green")), "red"),
        (Prompt("d", "number", "?"), "0"),
    ],
)
async def test_questions_are_kept_and_answered(dry: DryRunContext, prompt: Prompt, answer: str) -> None:
    assert await dry.ask(prompt) == answer
    assert dry.prompts == [prompt]


async def test_the_rest_of_the_context_is_kept(dry: DryRunContext) -> None:
    await dry.checkpoint()
    await dry.event("zero", number=1)
    await dry.warn("look", where="here")
    dry.progress(1.0, 2.0)
    assert await dry.joints() == HOME
    assert await dry.locate(0.5, (200.0, -30.0)) == Position(200.0, -30.0, 0.0)
    assert (await dry.measure_target("N1", 0.5, 4.0, (1.0, 2.0, 3.0))).place_mm == (1.0, 2.0, 3.0)
    assert (await dry.measure_frame("N1", 0.5, 4.0)).place_mm == (0.0, 0.0, 0.0)
    assert dry.total_s == 0.5 + 2 * 4.5
    assert dry.notes == [("zero", {"number": 1}), ("warning", {"text": "look", "where": "here"})]


async def test_rows_and_steps_follow_the_same_rules(dry: DryRunContext) -> None:
    async def inner() -> Row:
        return {}

    async def outer() -> Row:
        return await dry.step("inner", "inner", inner)

    with pytest.raises(RuntimeError, match="outside of a step"):
        dry.record(distance())
    with pytest.raises(RuntimeError, match="do not nest"):
        await dry.step("outer", "outer", outer)
