"""A procedure without instruments."""

import math
from dataclasses import replace

import pytest

from app.engine.arm_model import poses_between, reflector_beam
from app.engine.dry_run import DryRunContext
from app.errors import LimitError
from procedures.bench import Arm, Following
from procedures.context import Context, Prompt, Row
from tests.unit.app.engine.fakes import HOME, LIMITS, point

ARM = Arm(
    link1_mm=325.0,
    link2_mm=225.0,
    j1_limits_deg=(-170.0, 170.0),
    j2_limits_deg=(-145.0, 145.0),
    j4_limits_deg=(-360.0, 360.0),
    j3_mm=0.0,
    speed_deg_s=(100.0, 100.0, 100.0),
    acceleration_deg_s2=(200.0, 200.0, 200.0),
    override_percent=50.0,
    follow_speed_deg_s=10.0,
    follow_acceleration_deg_s2=math.pi * 50.0,
)
BEAM = reflector_beam(325.0, 225.0, {"P1": (650.0, 0.0), "P2": (0.0, 900.0)}, acceptance_mm=1.0)


@pytest.fixture
def dry() -> DryRunContext:
    return DryRunContext(LIMITS, ARM, BEAM)


@pytest.mark.parametrize(
    ("following", "duration_s"),
    # Twice 50 deg at 50 deg/s with ramps of a quarter of a second; once 100 deg; led at 10 deg/s, ramps of a tenth.
    [("stops", 2.5), ("blended", 2.25), ("streamed", 10.1)],
)
async def test_the_time_of_a_way_is_that_of_the_arms_way_of_following(
    following: Following, duration_s: float
) -> None:
    dry = DryRunContext(LIMITS, replace(ARM, following=following), BEAM)
    await dry.follow(((50.0, 0.0, 0.0, 0.0), (100.0, 0.0, 0.0, 0.0)))
    assert dry.total_s == pytest.approx(duration_s)
    assert dry.pose == (100.0, 0.0, 0.0, 0.0)
    with pytest.raises(LimitError, match="J2"):
        await dry.follow(((50.0, 0.0, 0.0, 0.0), (50.0, 150.0, 0.0, 0.0)))


def test_the_ideal_beam_returns_from_the_reflector_that_it_hits() -> None:
    assert BEAM((0.0, 0.0, 0.0, 0.0)) == pytest.approx(100.0)
    assert BEAM((90.0, 0.0, 0.0, 0.0)) == pytest.approx(350.0)
    assert BEAM((0.0, 0.0, 0.0, 180.0)) is None
    just_outside_deg = math.degrees(1.001 / 100.0)
    assert BEAM((0.0, 0.0, 0.0, just_outside_deg)) is None


def test_poses_on_the_way_end_at_the_target() -> None:
    poses = poses_between(HOME, (2.5, -1.0, 0.0, 0.0))
    assert len(poses) == 3
    assert poses[-1] == pytest.approx((2.5, -1.0, 0.0, 0.0))


async def test_it_gives_a_step_table_and_the_time(dry: DryRunContext) -> None:
    async def action() -> Row:
        await dry.move((100.0, 0.0, 0.0, 0.0))
        await dry.measure(0.5, 0.5, 5)
        dry.record("points", point())
        return {"done": True}

    context: Context = dry
    assert await context.step("s1", "first", action) == {"done": True}
    (step,) = dry.steps
    assert (step.moves, step.measurements, step.end) == (1, 1, (100.0, 0.0, 0.0, 0.0))
    assert step.duration_s == pytest.approx(3.25)
    assert dry.total_s == pytest.approx(3.25)
    assert len(dry.rows) == 1


async def test_limits_hold_at_every_move(dry: DryRunContext) -> None:
    with pytest.raises(LimitError, match="J2"):
        await dry.move((0.0, 150.0, 0.0, 0.0))


async def test_the_displacement_is_relative_to_the_zero(dry: DryRunContext) -> None:
    await dry.zero(500.0)
    measured = await dry.measure(0.5, 0.5, 1)
    assert (measured.displacement_mm, measured.beam_ok, measured.reported) == (0.0, True, HOME)
    assert dry.total_s == pytest.approx(0.5)


async def test_a_beam_that_broke_on_the_way_stays_lost_until_a_zero(dry: DryRunContext) -> None:
    await dry.zero(500.0)
    await dry.move((0.0, 0.0, 0.0, 5.0))
    await dry.move(HOME)
    assert not (await dry.measure(0.5, 0.5, 1)).beam_ok
    await dry.zero(500.0)
    assert (await dry.measure(0.5, 0.5, 1)).beam_ok


@pytest.mark.parametrize(
    ("prompt", "answer"),
    [
        (Prompt("a", "confirm", "?"), "yes"),
        (Prompt("b", "confirm", "?", safe_answer="no"), "no"),
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
    assert (await dry.locate(0.5)).u_mm == 0.0
    assert dry.notes == [("zero", {"number": 1}), ("warning", {"text": "look", "where": "here"})]


async def test_rows_and_steps_follow_the_same_rules(dry: DryRunContext) -> None:
    async def inner() -> Row:
        return {}

    async def outer() -> Row:
        return await dry.step("inner", "inner", inner)

    with pytest.raises(RuntimeError, match="outside of a step"):
        dry.record("points", point())
    with pytest.raises(RuntimeError, match="do not nest"):
        await dry.step("outer", "outer", outer)
