"""What a second look at the day's list saves: the figures of twenty runs that have not changed."""

import time
from pathlib import Path

from catseye.app.results.headlines import HEADLINES
from catseye.app.results.readiness.headline import Written
from catseye.app.results.readiness.remembered import Remembered
from tests.unit.app.test_path_comparison import distances, identified, stored

RUNS = 20


async def test_twenty_figures_are_remembered(tmp_path: Path) -> None:
    first, result = await identified(tmp_path)
    root = first.path.parent
    runs = [first.path] + [(await stored(root, "validation-path", distances())).path for _ in range(RUNS - 1)]
    page = tmp_path / "validation.html"

    def look_s() -> float:
        began_s = time.process_time()
        remembered = Remembered(root, lambda: HEADLINES)
        for run in runs:
            remembered.headlines.of_run(run)
            remembered.headlines.of_written(Written("validate", page, (result,), (run,)))
        remembered.keep()
        return time.process_time() - began_s

    anew_s = look_s()
    again_s = min(look_s() for _ in range(3))
    print(  # noqa: T201  # the figure
        f"\n{RUNS} runs: evaluated in {anew_s:.2f} s of CPU, looked up in {1e3 * again_s:.1f} ms "
        f"({anew_s / again_s:.0f} times quicker)"
    )
    assert again_s < 0.1 * anew_s
