"""The strip chart of 100 000 samples against what comes with Textual, and against Python's own min and max."""

import statistics
import time
from collections.abc import Callable

import numpy as np
from rich.color import Color
from rich.console import Console
from textual.renderables.sparkline import Sparkline

from catseye.app.tui.widgets.braille import Floats
from catseye.app.tui.widgets.strip_chart import dots_of, draw, fold, next_scale

SAMPLES = 100_000
COLUMNS, ROWS = 78, 12
ROUNDS = 15


def samples() -> Floats:
    values: Floats = np.random.default_rng(5).normal(743.12, 0.001, SAMPLES)
    return values


def strip(values: Floats) -> list[list[tuple[str, str]]]:
    """Fold, scale and draw."""
    dots = dots_of(COLUMNS)
    per_dot = -(-SAMPLES // dots)
    low, high = fold(values, values, SAMPLES, per_dot, dots)
    scale = next_scale(None, float(np.fmin.reduce(low)), float(np.fmax.reduce(high)))
    assert scale is not None
    return draw(low, high, scale, COLUMNS, ROWS)


def sparkline(values: list[float]) -> None:
    """Have Textual draw its one line of blocks, the largest value in each."""
    line = Sparkline(values, width=COLUMNS, min_color=Color.parse("red"), max_color=Color.parse("green"))
    list(Console(width=COLUMNS).render(line))


def plain(values: list[float]) -> list[tuple[float, float]]:
    """Search the extremes of each column of dots."""
    dots = dots_of(COLUMNS)
    per_dot = -(-SAMPLES // dots)
    parts = [values[first : first + per_dot] for first in range(0, SAMPLES, per_dot)]
    return [(min(part), max(part)) for part in parts]


def median_ms(work: Callable[[], object]) -> float:
    times = []
    for _ in range(ROUNDS):
        start_s = time.perf_counter()
        work()
        times.append(1e3 * (time.perf_counter() - start_s))
    return statistics.median(times)


def test_strip_of_a_hundred_thousand_samples() -> None:
    values = samples()
    listed = values.tolist()
    strip(values)
    ours, peer, python = (
        median_ms(lambda: strip(values)),
        median_ms(lambda: sparkline(listed)),
        median_ms(lambda: plain(listed)),
    )
    text = (
        f"strip {ours:.2f} ms, Textual's Sparkline {peer:.1f} ms, Python's min and max alone {python:.1f} ms"
    )
    print(f"\n{SAMPLES} samples, {COLUMNS} × {ROWS} cells: {text} (limit: a half of both)")  # noqa: T201  # the figure
    assert ours < peer / 2.0
    assert ours < python / 2.0
