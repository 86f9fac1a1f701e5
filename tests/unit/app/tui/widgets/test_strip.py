"""What becomes of columns that were missed, and of the strip when the engine is another one."""

from itertools import pairwise

from catseye.app.protocol.engine_events import SamplesTaken
from catseye.app.tui.engine_state import STRIP_COLUMNS, Column, EngineState
from catseye.app.tui.widgets.strip import Strip
from tests.unit.app.tui.scripted import shown, snapshot_with, started
from tests.unit.app.tui.scripted_bench import BENCH, publish_strip
from tests.unit.app.tui.widgets.dots import dots_of


def samples(values: list[float | None], missed: int = 0) -> SamplesTaken:
    return SamplesTaken(
        quantity="displacement_mm",
        period_s=0.02,
        low=tuple(values),
        high=tuple(values),
        count=tuple(0 if value is None else 1 for value in values),
        missed=missed,
    )


def test_missed_columns_are_gaps_and_counted() -> None:
    engine = EngineState()
    engine.take(samples([1.0, 2.0]), 0.0)
    engine.take(samples([3.0], missed=4), 0.2)
    gap = Column(None, None)
    assert list(engine.strip) == [Column(1.0, 1.0), Column(2.0, 2.0), gap, gap, gap, gap, Column(3.0, 3.0)]
    assert engine.strip_seen == 7
    assert engine.missed == {"samples": 4}
    engine.take(samples([5.0], missed=10 * STRIP_COLUMNS), 0.4)
    assert len(engine.strip) == STRIP_COLUMNS
    assert engine.strip[-1] == Column(5.0, 5.0)


def test_a_new_engine_begins_a_new_strip() -> None:
    engine = EngineState()
    engine.take(samples([1.0, 2.0]), 0.0)
    engine.lost("the engine is gone")
    engine.met(snapshot_with(), 9.0)
    assert not engine.strip


async def test_a_gap_is_as_wide_as_the_missed_time() -> None:
    async with started(size=(120, 40)) as (app, pilot, link):
        link.publish("bench", **BENCH)
        for values, missed in (([743.1] * 200, 0), ([743.1] * 200, 80)):
            link.engine.take(samples(list(values), missed), link.now_s)
        await shown(app, pilot)
        await shown(app, pilot)
        strip = app.screen.query_one(Strip)
        lines = [line[8:] for line in strip.shown.plain.splitlines()[1:-1]]
        drawn = sorted({x for x, _ in dots_of(lines)})
        jumps = [after - before for before, after in pairwise(drawn) if after > before + 1]
        per_dot = -(-500 // (2 * (strip.size.width - 8)))
        assert len(jumps) == 1
        assert abs((jumps[0] - 1) - 80 / per_dot) <= 1


async def test_the_scale_stays_while_nothing_comes() -> None:
    async with started(size=(120, 40)) as (app, pilot, link):
        link.publish("bench", **BENCH)
        publish_strip(link)
        await shown(app, pilot)
        strip = app.screen.query_one(Strip)
        scale = strip.scale
        assert scale is not None
        link.engine.take(samples([None] * 1000), link.now_s)
        await shown(app, pilot)
        assert strip.scale == scale
