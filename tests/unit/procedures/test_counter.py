"""A counter of wrong sign or scale is named within the first distances, and the run stops."""

from collections.abc import Awaitable, Callable
from dataclasses import dataclass, replace

import pytest

from catseye.procedures.kit.context import Measurement, Prompt
from catseye.procedures.kit.errors import CounterError, MostLeftOutError
from catseye.procedures.kit.live import Live
from catseye.procedures.kit.records import Row
from catseye.procedures.scara.open_loop.open_loop import OpenLoop
from catseye.procedures.scara.open_loop.open_loop_plan import plan_open_loop
from catseye.procedures.scara.search.reflector_search import ReflectorSearch, SearchParams
from tests.unit.procedures.benches import PLACES, IdealContext, bench

FIRST = 20
"""Distances within which a wrong counter has to be recognised."""

FOUND = {"P1": (657.0, -409.0), "P2": (669.0, 12.0), "P3": (646.0, 391.0)}
"""Where the reflectors really stand, up to 20 mm from their rough places."""


@dataclass
class MiscountingContext(IdealContext):
    """A bench whose counter has a factor of its own.

    Attributes:
        factor: what the counter multiplies with.
    """

    factor: float = 1.0

    async def measure(self, settle_time_s: float, dwell_time_s: float, readings: int) -> Measurement:
        """Return what the counter makes of a distance; its readings scatter by 0.1 µm of its own."""
        measured = await super().measure(settle_time_s, dwell_time_s, readings)
        return replace(
            measured,
            displacement_mm=self.factor * measured.displacement_mm,
            spread_mm=abs(self.factor) * measured.spread_mm,
        )


class SkippingContext(MiscountingContext):
    """Leaves out what does not settle, as a run without an operator does."""

    async def ask(self, prompt: Prompt, watch: Callable[[], Awaitable[Live]] | None = None) -> str:
        """Give the safe answer."""
        assert watch is None
        self.prompts.append(prompt)
        return prompt.safe_answer or ""


FACTORS = {
    "its sign is reversed": -1.0,
    r"as if m were read as mm, or mm as µm \(from": 1e-3,
    "as if inches were read as mm": 1.0 / 25.4,
    "as if µm were read as mm, or nm as µm": 1e3,
    r"as if counts of λ/4 were read as mm \(from": 1.0 / 158.2e-6,
    "gives 1.05 mm where": 1.05,
    "gives 0.95": 0.95,
    "mm as µm and falls": -1e-3,
}


async def measured(context: IdealContext) -> IdealContext:
    await OpenLoop().run(context, plan_open_loop(bench(), reflectors=("P1", "P2")))
    return context


@pytest.mark.parametrize(("text", "factor"), FACTORS.items())
async def test_open_loop_names_a_wrong_counter_and_stops(text: str, factor: float) -> None:
    context = SkippingContext(factor=factor)
    with pytest.raises(CounterError, match=text):
        await measured(context)
    assert len(context.stored) <= FIRST
    assert not any("seems to have been moved" in warning for warning in context.warnings)


async def searched(context: IdealContext) -> IdealContext:
    procedure = ReflectorSearch()
    await procedure.run(context, procedure.plan(bench(), SearchParams()))
    return context


@pytest.mark.parametrize(("text", "factor"), FACTORS.items())
async def test_a_search_names_a_wrong_counter_and_stops(text: str, factor: float) -> None:
    context = SkippingContext(FOUND, 1.4, factor=factor)
    with pytest.raises(CounterError, match=text):
        await searched(context)
    # Eight looks at the first reflector; the short way has few distances.
    assert len(context.stored) == 8
    assert context.measurements <= FIRST


@pytest.mark.parametrize("factor", [1.05, 0.95])
async def test_a_search_of_few_poses_names_a_wrong_scale(factor: float) -> None:
    context = SkippingContext(FOUND, 1.4, factor=factor)
    procedure = ReflectorSearch()
    with pytest.raises(CounterError, match=f"gives {factor:g}"):
        await procedure.run(context, procedure.plan(bench(), SearchParams(poses=4)))


async def test_a_search_that_shows_no_scale_says_so() -> None:
    # Every count is broken: the way is driven and shows nothing.
    context = await searched(MiscountingContext(FOUND, 1.4, breaks_at=set(range(1, 100)), factor=1.05))
    assert context.stored["solve"]["counter_shown"] is False
    assert any("could not verify the scale of the counter" in warning for warning in context.warnings)
    assert any("open-loop checks sign and scale" in warning for warning in context.warnings)


async def test_a_sound_counter_is_looked_at_once_in_a_search() -> None:
    context = await searched(MiscountingContext(FOUND, 1.4))
    assert [name for name in context.stored if name.startswith("counter/")] == ["counter/P1"]
    assert context.stored["counter/P1"] == {"checked": True}
    assert context.stored["solve"]["counter_shown"] is True
    assert context.zeros == 1


async def test_a_broken_count_is_looked_at_again() -> None:
    context = await searched(MiscountingContext(FOUND, 1.4, breaks_at={2}))
    assert context.stored["counter/P1"] == {"checked": True}
    assert context.zeros == 2


@pytest.mark.parametrize("factor", [1.0, 1.01, 0.99])
async def test_a_sound_counter_measures_all_points(factor: float) -> None:
    places = {name: (x + 2.0, y - 1.0) for name, (x, y) in PLACES.items()}
    context = MiscountingContext(places, acceptance_mm=10.0, factor=factor)
    plan = plan_open_loop(bench((-40.0, -20.0), (20.0, 40.0, 60.0)), reflectors=("P2",))
    await OpenLoop().run(context, plan)
    assert len([row for table, row in context.rows if table == "points"]) == 24


async def test_a_run_that_left_out_most_points_is_not_complete() -> None:
    with pytest.raises(MostLeftOutError, match=r"^13 of 24 points were left out"):
        await measured_but(13)
    assert len((await measured_but(11)).warnings) == 1


async def measured_but(count: int) -> IdealContext:
    """Return a measurement of 24 points whose first ones were left out before it was resumed."""
    plan = plan_open_loop(bench((-40.0, -20.0), (20.0, 40.0, 60.0)), reflectors=("P2",))
    context = IdealContext()
    row: Row = {"measured": False, "segment": 0, "reason": "no beam"}
    context.stored = {f"P2/{number:04d}": row for number in range(count)}
    await OpenLoop().run(context, plan)
    return context
