"""A small program with a live trace and an error map: drawn by us, by textual-plot, or not at all.

python -m tests.benchmarks.chart_peers ours|peer|none START_NS SECONDS OUTPUT: START_NS is the monotonic clock
when the program was called; figures go to OUTPUT.json, a picture to OUTPUT.svg. 1000 values a second come in, five
times a second the trace is drawn: both draw the same 10 s, folded by us into extremes of each column of dots.
"""

import asyncio
import json
import sys
import time
from pathlib import Path

RATE_HZ = 1000
WINDOW = 10 * RATE_HZ
REDRAWN_S = 0.2


def main() -> None:
    """Draw for some seconds."""
    kind, start_ns, seconds, output = sys.argv[1], int(sys.argv[2]), float(sys.argv[3]), Path(sys.argv[4])

    from textual.app import App, ComposeResult

    from tests.benchmarks import chart_widgets

    trace, error_map, feed = chart_widgets.KINDS[kind]()

    class Small(App[None]):
        CSS = "Screen { layout: vertical; } Screen > * { height: 1fr; }"

        def compose(self) -> ComposeResult:
            yield trace
            yield error_map

        def on_mount(self) -> None:
            # The map is drawn with the first frame that knows sizes, and painted with the one after.
            self.call_after_refresh(lambda: self.call_after_refresh(self._first))

        def _first(self) -> None:
            self.first_s = 1e-9 * (time.monotonic_ns() - start_ns)
            self.first_cpu_s = time.process_time()
            self.run_worker(self._measure())

        async def _measure(self) -> None:
            values: list[float] = []
            late_s: list[float] = []
            began_s, began_cpu_s = time.monotonic(), time.process_time()
            drawn = self.set_interval(REDRAWN_S, lambda: feed(values[-WINDOW:]))
            for number in range(int(seconds * RATE_HZ)):
                due_s = began_s + number / RATE_HZ
                await asyncio.sleep(max(due_s - time.monotonic(), 0.0))
                late_s.append(time.monotonic() - due_s)
                values.append(chart_widgets.value_at(number / RATE_HZ))
            drawn.stop()
            late_s.sort()
            figures = {
                "first_s": self.first_s,
                "first_cpu_s": self.first_cpu_s,
                "cpu_share": (time.process_time() - began_cpu_s) / (time.monotonic() - began_s),
                "late_p99_ms": 1e3 * late_s[round(0.99 * len(late_s)) - 1],
                "late_max_ms": 1e3 * late_s[-1],
            }
            output.with_suffix(".json").write_text(json.dumps(figures), encoding="utf-8")
            output.with_suffix(".svg").write_text(self.export_screenshot(title=kind), encoding="utf-8")
            self.exit()

    Small().run()


if __name__ == "__main__":
    main()
