"""What came of the runs of the proxy campaign: how they are judged by what was sent, kept and shown."""

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any, Final

from catseye.app.testing.mishaps import KINDS, Kind
from catseye.drivers.roles.device import Direction


@dataclass(frozen=True)
class Case:
    """One run.

    Attributes:
        plan: name of the plan.
        link: that goes wrong.
        way: tx towards the device, rx towards the program.
        kind: how it goes wrong.
        seed: of when and what.
    """

    plan: str
    link: str
    way: Direction
    kind: Kind
    seed: int

    def __str__(self) -> str:
        """Return what repeats it."""
        return f"{self.plan}/{self.link}/{self.way}/{self.kind}/{self.seed}"


@dataclass
class Outcome:
    """What came of a run.

    Attributes:
        struck: faults that struck.
        code: of the command's exit; None when it hung.
        took_s: real s.
        points: that were recorded.
        heals: links that were healed, and how often.
        said: errors on stderr, or its last lines.
        wrong: numbers that are not the bench's, in words.
        broken: other promises that were not kept, in words.
    """

    case: Case
    struck: int = 0
    code: int | None = None
    took_s: float = 0.0
    points: int = 0
    heals: int = 0
    said: str = ""
    wrong: list[str] = field(default_factory=list)
    broken: list[str] = field(default_factory=list)

    @property
    def fine(self) -> bool:
        """Whether all promises were kept; no driver can notice a digit that became another one."""
        return not self.broken and (not self.wrong or self.case.kind == "digit")

    @property
    def result(self) -> str:
        """In one or two words."""
        if self.wrong:
            return "wrong"
        if self.broken:
            return "broken"
        return "completed" if self.code == 0 else "clean stop"


def motions(entries: list[dict[str, Any]]) -> list[str]:
    """Return the motions that the arm has begun, and its arrivals and stops between them."""
    texts = [entry["text"] for entry in entries if entry["kind"] == "motion"]
    return [re.sub(r" at .* %", "", text) for text in texts]


def ordered(said: bytes) -> list[str]:
    """Return the targets of the motions that a MELFA was sent, each assigned on its own, and STOPs between."""
    found, target = [], _AGAIN
    for request in said.decode("ascii", "replace").split("\r"):
        if given := re.search(r"EXECJ\w+=(\(.*\))", request):
            target = given[1]
        elif "EXEC2=MOV" in request:
            found.append(target)
            target = _AGAIN
        elif request.endswith(";STOP"):
            found.append(f"STOP {len(found)}")
    return found


_AGAIN: Final = "the target that it was sent before"


def repeated(texts: Sequence[str]) -> list[str]:
    """Return what comes twice in a row."""
    return [now for before, now in pairwise(["", *texts]) if now in {before, _AGAIN}]


def line(outcome: Outcome) -> str:
    """Return a run as a line of JSON."""
    return json.dumps(
        {
            "case": str(outcome.case),
            "struck": outcome.struck,
            "result": outcome.result,
            "code": outcome.code,
            "took_s": round(outcome.took_s, 1),
            "points": outcome.points,
            "heals": outcome.heals,
            "said": outcome.said[-1000:],
            "wrong": outcome.wrong,
            "broken": outcome.broken,
        },
        ensure_ascii=False,
    )


def outcome_of(text: str) -> Outcome:
    """Return a run from its line of JSON."""
    told = json.loads(text)
    plan, link, way, kind, seed = told.pop("case").split("/")
    del told["result"]
    return Outcome(Case(plan, link, way, kind, int(seed)), **told)


def table(outcomes: Sequence[Outcome]) -> list[str]:
    """Return the runs by link and fault as the lines of a table, both ways and all seeds together."""
    links = dict.fromkeys((outcome.case.plan, outcome.case.link) for outcome in outcomes)
    lines = [f"| bench, link | {' | '.join(KINDS)} |", f"|---|{'---|' * len(KINDS)}"]
    for plan, link in links:
        row = [_cell(plan, link, kind, outcomes) for kind in KINDS]
        lines.append(f"| {plan}, {link} | {' | '.join(row)} |")
    return lines


def _cell(plan: str, link: str, kind: Kind, outcomes: Sequence[Outcome]) -> str:
    """Return runs, completed ones and clean stops of one fault, and what else came of it."""
    own = [one for one in outcomes if (one.case.plan, one.case.link, one.case.kind) == (plan, link, kind)]
    counts = [sum(one.result == result for one in own) for result in ("completed", "clean stop")]
    bad = [f"{sum(one.result == result for one in own)} {result}" for result in ("wrong", "broken")]
    return ", ".join([f"{len(own)}: {counts[0]} + {counts[1]}", *(text for text in bad if text[0] != "0")])
