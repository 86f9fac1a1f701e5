"""A small plan run end to end with a proxy on each link, of which one goes wrong in one way."""

import contextlib
import json
import random
import re
import subprocess
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import Any, Final

import numpy as np

from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.store.reader import RunReader
from catseye.app.testing.mishaps import KINDS, Kind, Mishaps
from catseye.app.testing.proxy import Proxy, ProxyThread
from catseye.drivers.links.endpoint import TcpEndpoint, parse_endpoint
from catseye.drivers.roles.device import Direction
from tests.system import forked
from tests.system.blocking import misfits_um, still_truth
from tests.system.command import Emulated, emulated, environment, forget_stops
from tests.system.lossy import PLACES
from tests.system.test_ways_of_following import ALL_THETA2, FEW_NODES

LIMIT_S: Final = 240.0
"""A run that is not over by then hangs: it takes seconds, and the longest time-out is the 120 s of a motion."""

Air = Mapping[str, float]

_LOOK_S: Final = 0.2
_SHARES: Final[Mapping[Kind, float]] = {"stall": 0.03, "half-close": 0.03}
_SHARE: Final = 0.08
_STILL_S: Final = 5.0
_SAID: Final = 3
_CLEAN: Final = frozenset({1, 3, 4, 5})
"""Exit codes of a clean stop."""


@dataclass(frozen=True)
class Link:
    """A link of a bench.

    Attributes:
        section: of the cell file.
        key: of its endpoint there.
        pieces: so many pass each way at least, in whole plans.
    """

    section: str
    key: str
    pieces: int = 30


@dataclass(frozen=True)
class Plan:
    """A bench, and what is run on it.

    Attributes:
        text: of the cell file.
        edit: what is replaced in it.
        links: by name.
        module: that emulates the bench.
        speed: of the bench.
        words: of the command, behind `run`.
        truth: writes the true arm, where it is not drawn from the seed.
        check: returns what is wrong with the numbers of a run.
        points: how many a complete run records.
    """

    text: str
    edit: Mapping[str, str]
    links: Mapping[str, Link]
    speed: str
    words: tuple[str, ...]
    check: Callable[[RunReader, Emulated, list[Air]], list[str]]
    points: tuple[str, int]
    module: str = "catseye"
    truth: Callable[[Path], Path] | None = None


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
        """Whether all promises were kept."""
        return not (self.wrong or self.broken)

    @property
    def result(self) -> str:
        """In one or two words."""
        if self.wrong:
            return "wrong"
        if self.broken:
            return "broken"
        return "completed" if self.code == 0 else "clean stop"


def _scara_check(record: RunReader, bench: Emulated, air: list[Air]) -> list[str]:
    """Compare distances, joints and air with the bench, which has no errors but those of its arm."""
    points = record.rows("points")
    if not points:
        return []
    off_um = np.abs(misfits_um(points, bench.ask(op="truth")["truth"]))
    wrong = [f"distance {at} is {off:.3f} µm off" for at, off in enumerate(off_um) if off > MOST_UM]
    for at, point in enumerate(points):
        for key, most in MOST_AIR.items():
            low, high = (pick(one[key] for one in air) for pick in (min, max))
            if not low - most < float(str(point[key])) < high + most:
                wrong.append(f"{key} of point {at} is {point[key]} instead of {low}…{high}")
        for joint in (1, 2):
            if (
                abs(float(str(point[f"reported{joint}_deg"])) - float(str(point[f"theta{joint}_deg"])))
                > MOST_DEG
            ):
                wrong.append(f"joint {joint} of point {at} is reported at {point[f'reported{joint}_deg']}")
    return wrong


MOST_UM: Final = 0.3
"""Of a distance on a bench without noise: digits of counter and controller, as in `test_lossy_links`."""

MOST_DEG: Final = 0.02
MOST_AIR: Final = {"temperature_c": 0.05, "pressure_hpa": 0.1, "humidity_percent": 0.5}

_SCARA_LINKS: Final = {
    "motion": Link("robot", "endpoint"),
    "stop": Link("robot.settings", "stop_endpoint", 2),
    "status": Link("robot.settings", "status_endpoint", 4),
    "interferometer": Link("interferometer", "endpoint"),
    "air": Link("environment", "endpoint"),
    "door": Link("io", "endpoint"),
}
_SCARA_EDIT: Final = {
    **FEW_NODES,
    ALL_THETA2: "theta2_deg = [20.0, 40.0]",
    "[robot.limits_deg]": (
        "[robot.settings]\nanswer_timeout_s = 0.5\n"
        'stop_endpoint = "tcp://127.0.0.1:10001"\nstatus_endpoint = "tcp://127.0.0.1:10001"\n\n[robot.limits_deg]'
    ),
    "[tracker]": '[io]\nendpoint = "tcp://127.0.0.1:10503"\n\n[tracker]',
}
_SCARA_WORDS: Final = ("open-loop", "--search", "none", "--param", 'reflectors=["P2"]')


def _truth(folder: Path) -> Path:
    return still_truth(folder, PLACES)


def _scara(edit: Mapping[str, str], links: Mapping[str, Link]) -> Plan:
    return Plan(
        TEMPLATE,
        {**_SCARA_EDIT, **edit},
        links,
        "100",
        _SCARA_WORDS,
        _scara_check,
        ("points", 18),
        "tests.system.still_bench",
        _truth,
    )


PLANS: Final[Mapping[str, Plan]] = {
    "scara": _scara({}, _SCARA_LINKS),
    "ids": _scara(
        {'driver = "line-counter"\n': 'driver = "attocube-ids"\n', 'profile = "default"\n': ""},
        {"interferometer": _SCARA_LINKS["interferometer"]},
    ),
    "datalink": _scara(
        {
            'driver = "melfa-r3"\n': 'driver = "melfa-datalink"\ndatalink_endpoint = "tcp://127.0.0.1:10003"\n',
        },
        {"data link": Link("robot", "datalink_endpoint")},
    ),
}


def cases(seeds: Sequence[int]) -> list[Case]:
    """Return every fault on each way of every link, seed by seed."""
    return [
        Case(name, link, way, kind, seed)
        for seed in seeds
        for name, plan in PLANS.items()
        for link in plan.links
        for way in WAYS
        for kind in KINDS
    ]


WAYS: Final[tuple[Direction, ...]] = ("tx", "rx")


def spent(case: Case, folder: Path) -> Outcome:
    """Carry out a run and judge it."""
    plan, outcome = PLANS[case.plan], Outcome(case)
    words = ["--truth", str(plan.truth(folder))] if plan.truth else ["--seed", "3"]
    with (
        emulated(
            folder, "--speed", plan.speed, *words, edit=dict(plan.edit), text=plan.text, module=plan.module
        ) as bench,
        _proxies(bench, plan) as proxies,
    ):
        rng = random.Random(str(case))
        share = _SHARES.get(case.kind, _SHARE)
        mishaps = Mishaps(
            case.kind, str(case), first=rng.randrange(plan.links[case.link].pieces), share=share
        )
        proxies[case.link].mishaps[case.way] = mishaps
        with _watched(bench) as air:
            _run(plan, bench, folder, outcome)
        outcome.struck = mishaps.struck
        _judge(plan, bench, folder, outcome, air)
    return outcome


@contextmanager
def _watched(bench: Emulated) -> Iterator[list[Air]]:
    """Note the true air, which drifts, from before the run until behind it."""
    seen, over = [], threading.Event()

    def note() -> None:
        seen.append(bench.ask(op="arm")["air"])

    def watch() -> None:
        while not over.wait(_LOOK_S):
            note()

    note()
    watcher = threading.Thread(target=watch)
    watcher.start()
    try:
        yield seen
    finally:
        over.set()
        watcher.join()
        note()


@contextmanager
def _proxies(bench: Emulated, plan: Plan) -> Iterator[dict[str, Proxy]]:
    """Put a proxy on each link of a running bench, and have the cell file lead through them."""
    text, proxies = bench.cell.read_text(encoding="utf-8"), {}
    with contextlib.ExitStack() as stack:
        threads = stack.enter_context(ProxyThread("proxies"))
        for name, link in plan.links.items():
            found = re.search(rf'(?s)\n\[{re.escape(link.section)}\].*?\n{link.key} = "(tcp:[^"]*)"', text)
            assert found, link
            target = parse_endpoint(found[1])
            assert isinstance(target, TcpEndpoint)
            proxies[name] = stack.enter_context(threads.proxy((target.host, target.port)))
            text = text[: found.start(1)] + proxies[name].endpoint + text[found.end(1) :]
        bench.cell.write_text(text, encoding="utf-8")
        try:
            yield proxies
        finally:
            for proxy in proxies.values():
                forget_stops(proxy.endpoint)


def _run(plan: Plan, bench: Emulated, folder: Path, outcome: Outcome) -> None:
    words: list[str | Path] = ["run", *plan.words, "--cell", bench.cell, "--speed", plan.speed]
    began_s = time.monotonic()
    try:
        done = forked.run("catseye", words, cwd=folder, env=environment(), limit_s=LIMIT_S)
    except subprocess.TimeoutExpired:
        outcome.broken.append(f"hangs: not over after {LIMIT_S:g} s")
    else:
        outcome.code = done.returncode
        lines = done.stderr.strip().splitlines()
        outcome.said = " / ".join([text for text in lines if text.startswith("error:")] or lines[-_SAID:])
        if "Traceback" in done.stderr:
            outcome.broken.append(f"a traceback: {outcome.said}")
    outcome.took_s = time.monotonic() - began_s


def _judge(plan: Plan, bench: Emulated, folder: Path, outcome: Outcome, air: list[Air]) -> None:
    if outcome.code is not None and outcome.code not in _CLEAN | {0}:
        outcome.broken.append(f"exit code {outcome.code}")
    if outcome.code and not outcome.said:
        outcome.broken.append(f"exit code {outcome.code} without a word")
    if not _stands(bench):
        outcome.broken.append("the arm moves on")
    outcome.broken += twice(bench.ask(op="log", device="robot")["entries"])
    table, complete = plan.points
    for run in sorted((folder / "catseye-runs").glob("*/run.sqlite")):
        record = RunReader(run.parent)
        outcome.points += len(record.rows(table))
        outcome.heals += sum(record.heals().values())
        outcome.wrong += plan.check(record, bench, air)
    if outcome.code == 0 and outcome.points != complete:
        outcome.broken.append(f"complete with {outcome.points} of {complete} points")


def _stands(bench: Emulated) -> bool:
    until_s = time.monotonic() + _STILL_S
    while bench.ask(op="arm")["moving"]:
        if time.monotonic() > until_s:
            return False
        time.sleep(0.05)
    return True


def twice(entries: list[dict[str, Any]]) -> list[str]:
    """Return motions that the arm began twice in a row."""
    begun = [
        re.sub(r" at .*", "", entry["text"])
        for entry in entries
        if entry["kind"] == "motion" and entry["text"].startswith("motion to")
    ]
    return [f"{now} begun twice" for before, now in pairwise(begun) if before == now]


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
