"""A procedure on the ideal bench of a test."""

from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import pytest
from pydantic import BaseModel, ConfigDict, ValidationError

from catseye.app.errors import LimitError
from catseye.app.testing.procedures import IdealContext, run_ideal
from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.bench import Bench
from catseye.procedures.kit.context import Context, Prompt
from catseye.procedures.kit.live import Live
from catseye.procedures.kit.procedure import Procedure
from catseye.procedures.kit.records import Record, Row


class Params(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True)

    angle_deg: float = 1.0


@dataclass(frozen=True, kw_only=True)
class Angle(Record):
    table: ClassVar[str] = "angles"
    angle_deg: float


class Wave(Procedure):
    """Asks, moves J1 and records where it is."""

    name = "wave"
    title = "Wave"
    params_type = Params
    records = (Angle,)
    torn_down = False

    def plan(self, bench: Bench, params: Params) -> float:
        del bench
        return params.angle_deg

    async def run(self, ctx: Context, plan: float) -> None:
        if await ctx.ask(Prompt("free", "confirm", "Is the way free?")) == "no":
            return
        assert not ctx.rehearsing

        async def wave() -> Row:
            await ctx.move((plan, 0.0, 50.0, 0.0))
            here = (await ctx.joints())[0]
            ctx.show(Live("J1", here, "deg"))
            ctx.record(Angle(angle_deg=here))
            return {"angle_deg": here}

        await ctx.step("wave", "wave", wave)

    async def teardown(self, ctx: Context) -> None:
        del ctx
        self.torn_down = True


class Sagging(IdealContext):
    async def joints(self) -> Pose:
        first, *others = await super().joints()
        return (first - 0.5, *others)


def test_the_test_sees_what_has_happened() -> None:
    wave = Wave()
    seen = run_ideal(wave, angle_deg=3.0)
    assert seen.results == {"wave": {"angle_deg": 3.0}}
    assert [live.value for live in seen.lives] == [3.0]
    assert seen.records == [Angle(angle_deg=3.0)]
    assert [prompt.id for prompt in seen.prompts] == ["free"]
    assert len(seen.motions) > 0
    assert wave.torn_down


def test_a_test_may_have_other_values_than_the_ideal_ones() -> None:
    assert run_ideal(Wave(), context=Sagging).results["wave"] == {"angle_deg": 0.5}


def test_a_test_answers_questions() -> None:
    assert run_ideal(Wave(), answers={"free": "no"}).results == {}
    with pytest.raises(ValueError, match="'free' was answered by 'perhaps': answer yes or no"):
        run_ideal(Wave(), answers={"free": "perhaps"})


def test_limits_hold_as_in_a_run() -> None:
    with pytest.raises(LimitError, match="J1 = 171"):
        run_ideal(Wave(), angle_deg=171.0)


def test_a_wrong_parameter_is_refused() -> None:
    with pytest.raises(ValidationError):
        run_ideal(Wave(), angle="3")


def test_a_step_that_is_done_is_not_repeated() -> None:
    seen = run_ideal(Wave(), done={"wave": {"angle_deg": 9.0}})
    assert seen.results["wave"] == {"angle_deg": 9.0}
    assert seen.motions == []


def test_the_cell_is_that_of_the_test(tmp_path: Path) -> None:
    cell = tmp_path / "cell.toml"
    cell.write_text(
        'format = "catseye-cell/1"\nname = "bare"\n[robot]\ndriver = "melfa-r3"\n'
        'endpoint = "tcp://127.0.0.1:10001"\n[robot.limits_deg]\nj1 = [-1.0, 1.0]\n',
        encoding="utf-8",
    )
    with pytest.raises(LimitError, match="J1 = 3"):
        run_ideal(Wave(), cell=cell, angle_deg=3.0)
