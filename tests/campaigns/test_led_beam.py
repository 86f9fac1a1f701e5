"""What the beam misses when the arm is led by set points, on the bench with all its errors, in virtual time."""

import pytest

from catseye.simulators.melfa.mxt import MxtOptions
from tests.streamed_bench import VirtualContext, tracked, tracked_without_errors

POINTS = 72
"""At nodes; a few more lie between them."""


def report(what: str, context: VirtualContext) -> None:
    """Print the largest misses of a run."""
    kept, rest, following = (
        max(values) for values in (context.kept_mm, context.rest_mm, context.following_mm)
    )
    print(  # noqa: T201  # the figure
        f"\n{what}: {points(context)} points, {len(context.kept_mm)} ways; largest miss {kept:.3f} "
        f"mm, of an arm at rest {rest:.3f} mm, because joints lag differently {following:.4f} mm"
    )


def points(context: VirtualContext) -> int:
    """Return how many points were measured."""
    return sum(table == "points" for table, _ in context.rows)


@pytest.mark.timeout(1800)
@pytest.mark.parametrize("seed", [1, 2, 3])
async def test_learned_lags_take_away_what_following_misses(seed: int) -> None:
    plain = await tracked(seed, MxtOptions(), most_lead_ms=0.0)
    led = await tracked(seed, MxtOptions())
    report(f"seed {seed}, all set points at once", plain)
    report(f"seed {seed}, lags learned", led)
    for context in (plain, led):
        assert points(context) >= POINTS
        assert {row["segment"] for table, row in context.rows if table == "points"} == {0}
    assert max(led.following_mm) < 0.25 * max(plain.following_mm)
    # What is left is the aim: links, error maps and play are not known before the measurement.
    assert max(led.kept_mm) < max(plain.kept_mm)


@pytest.mark.timeout(1800)
async def test_learned_lags_take_away_what_a_perfect_bench_misses() -> None:
    plain = await tracked_without_errors(most_lead_ms=0.0)
    led = await tracked_without_errors()
    report("no errors, all set points at once", plain)
    report("no errors, lags learned", led)
    assert max(led.kept_mm) < 0.5 * max(plain.kept_mm)
