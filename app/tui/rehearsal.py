"""What a rehearsal found, as lines to look at."""

from dataclasses import dataclass
from typing import Any, Final

from catseye.app.results.numbers import duration_text

HEADER: Final = (
    f"{'step':<22} {'moves':>5} {'pts':>4} {'time':>9}  "
    f"{'J1':>8} {'J2':>8} {'J4':>8} {'beam mm':>8} {'miss mm':>8}"
)


@dataclass(frozen=True)
class Rehearsal:
    """A plan that was gone through without any device.

    Attributes:
        facts: as `catseye run --dry-run --json` writes them.
    """

    facts: dict[str, Any]

    @property
    def steps(self) -> list[dict[str, Any]]:
        """The steps, in order."""
        return list(self.facts["steps"])

    @property
    def totals(self) -> str:
        """Everything in one or two lines."""
        facts, steps = self.facts, self.steps
        moves, points = (sum(int(step[key]) for step in steps) for key in ("moves", "measurements"))
        missing = facts.get("miss_mm")
        miss = "" if missing is None else f"; beam misses by {missing:.3f} mm at most"
        return (
            f"{len(steps)} steps, {moves} moves, {points} distances, {duration_text(float(facts['total_s']))} at "
            f"{facts['override_percent']:g} % override; joints to {facts['joint_deg_s']:.1f} deg/s, tool to "
            f"{facts['tool_mm_s']:.0f} mm/s{miss}"
        )

    @property
    def first(self) -> str:
        """Where the arm is after the first step that moves it."""
        step = next((each for each in self.steps if each["moves"]), None)
        if step is None:
            return "the arm does not move"
        one, two, three, four = step["end"]
        return f"first to J1 {one:.2f}°, J2 {two:.2f}°, J3 {three:.1f} mm, J4 {four:.2f}°"

    @property
    def warnings(self) -> list[str]:
        """What to know before it runs."""
        return [str(text) for text in self.facts.get("warnings", [])]

    @property
    def questions(self) -> list[str]:
        """What will be asked, each once."""
        return list(dict.fromkeys(str(each["text"]) for each in self.facts.get("questions", [])))

    def table(self) -> list[str]:
        """Return a line for each step, below `HEADER`."""
        return [_row(step) for step in self.steps]


def _row(step: dict[str, Any]) -> str:
    j1, j2, _, j4 = step["end"]
    name = str(step["step"])
    return (
        f"{name if len(name) <= 22 else name[:21] + '…':<22} {step['moves']:>5} {step['measurements']:>4} "
        f"{duration_text(float(step['duration_s'])):>9}  {j1:>8.2f} {j2:>8.2f} {j4:>8.2f} "
        f"{_number(step['beam_mm'], 1):>8} {_number(step['miss_mm'], 3):>8}"
    )


def _number(value: float | None, digits: int) -> str:
    return "–" if value is None else f"{value:.{digits}f}"
