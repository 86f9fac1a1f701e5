"""A small plan run end to end with a proxy on each link, of which one goes wrong in one way."""

import contextlib
import math
import random
import re
import subprocess
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any, Final

import numpy as np

from catseye.app.cell.resolution.template import BY_ARM
from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.cell.templates import SIX_AXIS, TEMPLATES
from catseye.app.store.reader import RunReader
from catseye.app.testing.mishaps import KINDS, Kind, Mishaps
from catseye.app.testing.proxy import Proxy, ProxyThread
from catseye.drivers.links.endpoint import TcpEndpoint, parse_endpoint
from catseye.drivers.roles.device import Direction
from tests.system import forked
from tests.system.blocking import misfits_um, still_truth
from tests.system.command import Emulated, emulated, environment, forget_stops
from tests.system.lossy import PLACES
from tests.system.proxied_outcomes import Case, Outcome, motions, ordered, repeated
from tests.system.test_ways_of_following import ALL_THETA2, FEW_NODES

LIMIT_S: Final = 600.0
"""A run that is not over by then hangs: it takes seconds, and the longest time-out is the 120 s of a motion."""

Seen = Mapping[str, Any]
"""What the control port said of the bench at some moment."""


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
        points: table, and how many rows of it a complete run records.
        watched: what the control port is asked for again and again.
        look_s: how often, real s.
    """

    text: str
    edit: Mapping[str, str]
    links: Mapping[str, Link]
    speed: str
    words: tuple[str, ...]
    check: Callable[[RunReader, Emulated, list[Seen]], list[str]]
    points: tuple[str, int]
    watched: str = "arm"
    look_s: float = 0.5
    module: str = "catseye"
    truth: Callable[[Path], Path] | None = None


def _scara_check(record: RunReader, bench: Emulated, seen: list[Seen]) -> list[str]:
    """Compare distances, joints and air with the bench, which has no errors but those of its arm."""
    points = record.rows("points")
    if not points:
        return []
    off_um = np.abs(misfits_um(points, bench.ask(op="truth")["truth"]))
    wrong = [f"distance {at} is {off:.3f} µm off" for at, off in enumerate(off_um) if off > MOST_UM]
    for at, point in enumerate(points):
        for key, most in MOST_AIR.items():
            low, high = (pick(one["air"][key] for one in seen) for pick in (min, max))
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

MOTION: Final = "motion"
"""The link on which a MELFA is sent its motions."""

_MELFA: Final = frozenset({MOTION, "stop", "status"})

_SCARA_LINKS: Final = {
    MOTION: Link("robot", "endpoint"),
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


def _params(*params: str) -> tuple[str, ...]:
    return tuple(word for param in params for word in ("--param", param))


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
        module="tests.system.still_bench",
        truth=_truth,
    )


def _kuka_check(record: RunReader, bench: Emulated, seen: list[Seen]) -> list[str]:
    """Compare the axis as it was read back with the angles at which it stood."""
    del bench
    stood = np.array(
        [now["joints"][_A5] for before, now in pairwise(seen) if before["joints"] == now["joints"]]
    )
    return [
        f"{key} of move {move['number']} is {move[key]}, {off:.4f}° from where the arm stood"
        for move in record.rows("moves")
        for key in ("measured_before", "measured_after")
        if (off := float(np.abs(stood - float(str(move[key]))).min())) > MOST_READ_BACK_DEG
    ]


def _abb_check(record: RunReader, bench: Emulated, seen: list[Seen]) -> list[str]:
    """Compare the places of targets with those at which they stood."""
    del bench
    wrong = []
    for row in record.rows("targets"):
        target = str(row["target"])
        stood = [
            np.linalg.inv(np.array(now["tracker"])) @ [*now["nests"][target], 1.0]
            for before, now in pairwise(seen)
            if math.dist(before["nests"][target], now["nests"][target]) < STILL_MM
        ]
        place = np.array([float(str(row[key])) for key in ("x_mm", "y_mm", "z_mm")])
        u_mm = max(float(str(row[key])) for key in ("u_x_mm", "u_y_mm", "u_z_mm"))
        off_mm = float(np.linalg.norm(np.array(stood)[:, :3] - place, axis=1).min())
        if off_mm > MOST_U * u_mm:
            wrong.append(f"{target} of pose {row['pose']} is {off_mm:.3f} mm off, u = {u_mm:.4f} mm")
    return wrong


_A5: Final = 4
MOST_READ_BACK_DEG: Final = 0.002
MOST_U: Final = 5.0
STILL_MM: Final = 0.002

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
    "kuka": Plan(
        BY_ARM["kr210-r2700"],
        {},
        {"robot": Link("robot", "endpoint")},
        "10",
        (
            "resolution",
            *_params(
                'joints=["A5"]',
                'positions=["K3"]',
                "directions=[1]",
                "steps=6",
                "dwell_s=1.0",
                "accept_slow_counter=true",
            ),
        ),
        _kuka_check,
        ("moves", 6),
        look_s=0.05,
    ),
    "abb": Plan(
        TEMPLATES[SIX_AXIS].text,
        {},
        {"robot": Link("robot", "endpoint"), "tracker": Link("tracker", "endpoint")},
        "20",
        ("tracker-validation", *_params("count=4", "nests_every=2", "dwell_s=2")),
        _abb_check,
        ("targets", 4),
        watched="survey",
        look_s=0.03,
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
        said = bytearray()
        for name in _MELFA & proxies.keys():
            proxies[name].heard = said.extend
        with _watched(plan, bench) as seen:
            _run(plan, bench, folder, outcome)
        outcome.struck = mishaps.struck
        _judge(plan, bench, folder, outcome, seen, bytes(said))
    return outcome


@contextmanager
def _watched(plan: Plan, bench: Emulated) -> Iterator[list[Seen]]:
    """Note the truth, which drifts and moves, from before the run until behind it."""
    seen: list[Seen] = []
    over = threading.Event()

    def note() -> None:
        seen.append(bench.ask(op=plan.watched))

    def watch() -> None:
        while not over.wait(plan.look_s):
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
        begins = [at for at, text in enumerate(lines) if text.startswith("error:")]
        outcome.said = " / ".join(lines[begins[0] if begins else -_SAID :])
        if "Traceback" in done.stderr:
            outcome.broken.append(f"a traceback: {outcome.said}")
    outcome.took_s = time.monotonic() - began_s


def _judge(
    plan: Plan, bench: Emulated, folder: Path, outcome: Outcome, seen: list[Seen], said: bytes
) -> None:
    if outcome.code is not None and outcome.code not in _CLEAN | {0}:
        outcome.broken.append(f"exit code {outcome.code}")
    if outcome.code and not outcome.said:
        outcome.broken.append(f"exit code {outcome.code} without a word")
    if not _stands(bench):
        outcome.broken.append("the arm moves on")
    if not (outcome.case.kind == "duplicate" and outcome.case.link == MOTION and outcome.case.way == "tx"):
        # There the link itself doubles orders.
        begun = motions(bench.ask(op="log", device="robot")["entries"])
        outcome.broken += [f"{text} twice" for text in repeated(begun) if text.startswith("motion to")]
    table, complete = plan.points
    restarts = 0
    for run in sorted((folder / "catseye-runs").glob("*/run.sqlite")):
        record = RunReader(run.parent)
        outcome.points += len(record.rows(table))
        outcome.heals += sum(record.heals().values())
        outcome.wrong += plan.check(record, bench, seen)
        restarts += sum(event.kind == "beam-lost" for event in record.events())
    resent = repeated(ordered(said))
    # A segment that begins again may lead the arm to where it stands.
    if len(resent) > restarts:
        outcome.broken += [f"{order} sent twice" for order in resent]
    if outcome.code == 0 and outcome.points != complete:
        outcome.broken.append(f"complete with {outcome.points} of {complete} points")


def _stands(bench: Emulated) -> bool:
    until_s = time.monotonic() + _STILL_S
    while bench.ask(op="arm")["moving"]:
        if time.monotonic() > until_s:
            return False
        time.sleep(0.05)
    return True
