"""A reflector that somebody moves during an open-loop measurement."""

from catseye.procedures.scara.open_loop.open_loop import OpenLoop
from catseye.procedures.scara.open_loop.open_loop_plan import plan_open_loop
from tests.unit.procedures.benches import bench
from tests.unit.procedures.troubles import TroubledContext

NODES = (-80.0, -40.0, 0.0), (20.0, 60.0, 100.0)
POINTS_OF_P1 = 36


async def measured(moved_by_mm: float) -> TroubledContext:
    """Measure with P1 and P2; P2 is moved after a dozen of its points."""
    context = TroubledContext()
    place = context.places["P2"]

    def move(number: int) -> None:
        away_mm = moved_by_mm if number > POINTS_OF_P1 + 14 else 0.0
        context.places["P2"] = (place[0] + away_mm, place[1] - away_mm)

    context.before_measuring = move
    await OpenLoop().run(context, plan_open_loop(bench(*NODES), reflectors=("P1", "P2"), closures=2))
    return context


async def test_a_moved_reflector_is_warned_about_once_with_remedy() -> None:
    (text,) = [each for each in (await measured(0.5)).warnings if "moved" in each]
    assert text.startswith("P2 or the interferometer seems to have been moved: ")
    assert "hold the run and look" in text
    assert "a new search and a new run" in text


async def test_a_bench_that_nobody_touches_is_not_suspected() -> None:
    assert not [text for text in (await measured(0.0)).warnings if "moved" in text]
