"""Rules of safety mean the same at every front end: the terminal of a run, the terminal UI, `attach`, a script.

Each rule is a table. Every front end is taken through all of it.
"""

import asyncio
import json
import os
import signal
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator
from contextlib import AbstractAsyncContextManager, asynccontextmanager, suppress
from dataclasses import replace
from typing import Literal

import pytest

from catseye.app.cli.attached import People
from catseye.app.cli.question_line import live_text
from catseye.app.engine.operator import Operator
from catseye.app.errors import PromptUnansweredError
from catseye.app.protocol.answers import Climbed
from catseye.app.protocol.events import encode_event, event_of
from catseye.app.protocol.ladder import Rung, rung_of
from catseye.app.protocol.loss import LossPolicy
from catseye.app.protocol.prompts import MotionAfter
from catseye.app.protocol.requests import AnyRequest, Plain
from catseye.app.protocol.run_events import LiveData, PromptAsked
from catseye.app.protocol.state import ENDED, ControlState
from catseye.app.service.client import EngineClient
from catseye.app.service.console import Console
from catseye.app.service.errors import RefusedError
from catseye.app.service.questions import MOTION_WORD, answer_of
from catseye.app.tui.widgets.static_text import StaticText
from catseye.drivers.roles.interferometer import BeamStatus
from catseye.procedures.kit.beam.loss import BeamLossPolicy
from catseye.procedures.kit.context import Prompt
from catseye.procedures.kit.live import Live
from tests.patience import HANG_S
from tests.unit.app.engine.fakes import ManualClock
from tests.unit.app.service.benches import ServiceBench, settled
from tests.unit.app.tui.screens.run_screen import answers, app_of
from tests.unit.app.tui.screens.run_screen import settled as painted
from tests.unit.app.tui.scripted import ScriptedLink, make_app
from tests.unit.app.tui.scripted_run import SNAPSHOT, ask, publish
from tests.unit.procedures.benches import IdealContext
from tests.unit.procedures.test_beam_loss import GONE, loss_on

Key = Literal["Ctrl-C", "stop"]
Press = Callable[[Key], Awaitable[None]]
FrontEnd = Callable[[ServiceBench], AbstractAsyncContextManager[Press]]
S = ControlState


@asynccontextmanager
async def terminal(bench: ServiceBench) -> AsyncIterator[Press]:
    """The terminal of the run's own process."""
    console = Console(bench.registry, "Ada", lambda _text: None)

    async def press(key: Key) -> None:
        if key == "Ctrl-C":
            bench.control.on_signal(signal.SIGINT)
        else:
            console.take("/s")

    yield press


@asynccontextmanager
async def attached(bench: ServiceBench) -> AsyncIterator[Press]:
    """`catseye attach --control`."""
    async with bench.client() as client:
        await client.take_control()
        front = People(client, control=True)
        task = asyncio.create_task(front.follow())
        await settled()

        async def press(key: Key) -> None:
            if key == "Ctrl-C":
                os.kill(os.getpid(), signal.SIGINT)
            else:
                front.typed("/s")
            await settled()

        yield press
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)


@asynccontextmanager
async def script(bench: ServiceBench) -> AsyncIterator[Press]:
    """A program on the socket."""
    async with bench.client() as client:

        async def press(key: Key) -> None:
            # Where no rung is left the request is refused.
            with suppress(RefusedError):
                if key == "Ctrl-C":
                    await client.ask(Plain(op="ladder"), Climbed)
                else:
                    await client.request(Plain(op="stop"))

        yield press


class BenchLink(ScriptedLink):
    """Shows a run, and puts its requests to a bench.

    Args:
        client: of the bench.
    """

    def __init__(self, client: EngineClient) -> None:
        super().__init__(SNAPSHOT)
        self._client = client

    async def request(self, request: AnyRequest) -> None:
        await super().request(request)
        await self._client.request(request)


@asynccontextmanager
async def terminal_ui(bench: ServiceBench) -> AsyncIterator[Press]:
    """The terminal UI, which sees the state of the run a moment late: here never."""
    async with bench.client() as client:
        app = make_app(BenchLink(client))
        async with app.run_test(size=(80, 24)) as pilot:

            async def press(key: Key) -> None:
                await pilot.press("ctrl+c" if key == "Ctrl-C" else "f12")
                await settled()
                await pilot.pause()

            yield press


FRONT_ENDS: list[FrontEnd] = [terminal, attached, script, terminal_ui]


@pytest.fixture
def stdin(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    reading, writing = os.pipe()
    with os.fdopen(reading) as silent:
        monkeypatch.setattr("sys.stdin", silent)
        yield
        os.close(writing)


@pytest.mark.usefixtures("stdin")
@pytest.mark.parametrize("key", ["Ctrl-C", "stop"])
@pytest.mark.parametrize("front_end", FRONT_ENDS)
async def test_a_key_takes_the_rung_of_every_state(
    front_end: FrontEnd, key: Key, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Ctrl-C climbs by the table; the stop key stops whatever has not ended."""
    taken: list[Rung] = []
    async with ServiceBench().running() as bench, asyncio.timeout(HANG_S), front_end(bench) as press:
        for rung in Rung:
            monkeypatch.setattr(bench.control, rung, lambda _reason, rung=rung: taken.append(rung))
        for state in S:
            taken.clear()
            bench.control.state = state
            await press(key)
            stopped = None if state in ENDED else Rung.STOP
            expected = rung_of(state) if key == "Ctrl-C" else stopped
            assert taken == ([] if expected is None else [expected]), state
        bench.control.state = S.EXECUTE
        monkeypatch.undo()


@pytest.mark.usefixtures("stdin")
@pytest.mark.parametrize("front_end", FRONT_ENDS)
async def test_two_quick_presses_climb_two_rungs(front_end: FrontEnd) -> None:
    async with ServiceBench().running() as bench, asyncio.timeout(HANG_S), front_end(bench) as press:
        await press("Ctrl-C")
        assert bench.robot.calls == []
        await press("Ctrl-C")
        await settled()
        assert bench.robot.calls == ["stop"]


async def test_between_runs_nothing_is_left_to_climb() -> None:
    bench = ServiceBench()
    async with bench.client() as client:
        with pytest.raises(RefusedError, match="no run is under way"):
            await client.request(Plain(op="ladder"))
        await bench.server.end()


HERE = (1.0, 2.0, 3.0, 4.0)
CONFIRM = Prompt("q", "confirm", "Clear?", motion=True, target=HERE)
QUESTION = Prompt("q", "confirm", "Is it there?")
CHOICE = Prompt("q", "choice", "Which?", ("retry", "skip", "stop"), safe_answer="stop", motion=True)
RESTING = replace(CHOICE, rests_after=("skip", "stop"))
RESTLESS = replace(CHOICE, rests_after=())
NUMBER = Prompt("q", "number", "How far?", unit="mm", motion=True)
TEXT = Prompt("q", "text", "Why?", motion=True, rests_after=("no",))

MOVES = [
    (CONFIRM, "yes", True),
    (CONFIRM, "no", False),
    (QUESTION, "yes", False),
    (CHOICE, "retry", True),
    (CHOICE, "skip", True),
    (CHOICE, "stop", False),
    (RESTING, "retry", True),
    (RESTING, "skip", False),
    (RESTLESS, "stop", True),
    (NUMBER, "5", True),
    (TEXT, "somebody looked", True),
    (TEXT, "no", False),
]
"""Questions, answers, and whether the arm moves after them."""


def over_the_wire(prompt: Prompt) -> Prompt:
    asked = PromptAsked.of(prompt, MotionAfter(override_percent=10.0, speed_deg_s=None))
    event = event_of(json.loads(encode_event(asked)))
    assert isinstance(event, PromptAsked)
    return event.prompt


@pytest.mark.parametrize(("prompt", "answer", "moves"), MOVES)
def test_both_ends_agree_which_answer_moves_the_arm(prompt: Prompt, answer: str, moves: bool) -> None:
    assert prompt.moves_after(answer) == moves
    assert over_the_wire(prompt) == replace(prompt, rests_after=over_the_wire(prompt).rests_after)
    assert over_the_wire(prompt).moves_after(answer) == moves


@pytest.mark.parametrize("carried", [lambda prompt: prompt, over_the_wire], ids=["terminal", "attach"])
@pytest.mark.parametrize(("prompt", "answer", "moves"), MOVES)
def test_a_terminal_takes_no_key_for_a_motion(
    prompt: Prompt, answer: str, moves: bool, carried: Callable[[Prompt], Prompt]
) -> None:
    text, fault = answer_of(carried(prompt), answer)
    if prompt.kind == "confirm" and moves:
        assert (text, answer_of(carried(prompt), "y")[0]) == ("", "")
        assert MOTION_WORD in fault
        assert answer_of(carried(prompt), MOTION_WORD) == (answer, "")
    else:
        # Whoever types a choice, a number or a text has typed a word of its own.
        assert (text, fault) == (answer, "")
    assert answer_of(carried(prompt), "")[0] == ""


@pytest.mark.parametrize(("prompt", "answer", "moves"), MOVES)
async def test_an_answers_file_moves_no_real_arm(prompt: Prompt, answer: str, moves: bool) -> None:
    operator = Operator(ManualClock(), {prompt.id: answer}, None, simulated=False)
    try:
        who = (await operator.answer(prompt)).who
    except PromptUnansweredError:
        who = "nobody"
    assert (who == "answers file") == (not moves)


async def test_the_terminal_ui_has_an_own_key_for_motion() -> None:
    link = ScriptedLink(SNAPSHOT)
    app = app_of(link)
    async with app.run_test(size=(120, 40)) as pilot:
        for number, (prompt, answer, moves) in enumerate(MOVES):
            asked = PromptAsked.of(prompt, MotionAfter(override_percent=10.0, speed_deg_s=None))
            fields = {**asked.json_object(), "id": f"q/{number}"}
            ask(link, **{name: fields[name] for name in fields if name not in {"t", "event", "run"}})
            await painted(app, pilot, link)
            if prompt.kind in {"confirm", "choice"}:
                await pilot.press(
                    answer[0] if prompt.kind == "confirm" else str(prompt.choices.index(answer) + 1)
                )
            else:
                await pilot.press(*("space" if letter == " " else letter for letter in answer), "enter")
            await painted(app, pilot, link)
            given = [(f"q/{number}", answer)]
            assert answers(link)[number:] == ([] if moves else given), (prompt, answer)
            if moves:
                await pilot.press("f8")
                await painted(app, pilot, link)
            assert answers(link)[number:] == given, (prompt, answer)


@pytest.mark.parametrize(
    ("answer", "moves"), [("retry", True), ("skip", True), ("stop", False)], ids=["retry", "skip", "stop"]
)
async def test_every_answer_to_a_lost_beam_but_stop_moves(answer: str, moves: bool) -> None:
    """One policy asks it in every procedure; front ends know of it what they know of any question."""
    ctx = IdealContext(places={"P1": (1000.0, 0.0)}, answers={"beam/P1/1": "skip"})
    await loss_on(ctx, BeamLossPolicy(attempts=1, may_skip=True)).decide(GONE, "θ1 10°")
    [prompt] = ctx.prompts
    assert prompt.safe_answer == "stop"
    for carried in (prompt, over_the_wire(prompt)):
        assert carried.moves_after(answer) == moves


LOSSES: list[tuple[LossPolicy, Rung | None, frozenset[ControlState]]] = [
    ("continue", None, frozenset(S)),
    ("hold", Rung.HOLD, ENDED | {S.STOPPING, S.ABORTING, S.HOLDING, S.HELD}),
    ("stop", Rung.STOP, ENDED | {S.STOPPING, S.ABORTING}),
]
"""What a lost client with control leads to, and the states in which that changes nothing."""


@pytest.mark.parametrize(("policy", "rung", "nothing"), LOSSES)
async def test_a_lost_client_means_the_same_in_every_state(
    policy: LossPolicy,
    rung: Rung | None,
    nothing: frozenset[ControlState],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Terminal UI, `attach` and scripts are clients; the reader of a headless run's events is held for by "hold"."""
    taken: list[Rung] = []
    async with ServiceBench().running() as bench, asyncio.timeout(HANG_S):
        bench.registry.policy = policy
        monkeypatch.setattr(bench.control, "stop", lambda _reason: taken.append(Rung.STOP))
        monkeypatch.setattr(bench.control, "hold_before_motion", lambda _reason: taken.append(Rung.HOLD))
        for state in S:
            taken.clear()
            bench.control.state = S.EXECUTE
            async with bench.client() as client:
                await client.take_control()
                bench.control.state = state
            await settled()
            assert taken == ([] if rung is None or state in nothing else [rung]), state
        bench.control.state = S.EXECUTE
        monkeypatch.undo()


SOUND = BeamStatus(beam_ok=True, beam_lost=False, overspeed=False, laser_ready=True, signal=0.8)


@pytest.mark.parametrize(
    ("status", "valid"),
    [
        (SOUND, True),
        # A weak beam and values that a stream lost leave the count as it is.
        (replace(SOUND, signal=0.01, values_lost=True), True),
        (replace(SOUND, beam_ok=False), False),
        (replace(SOUND, beam_lost=True), False),
        (replace(SOUND, overspeed=True), False),
        (replace(SOUND, laser_ready=False), False),
    ],
)
def test_a_count_is_valid_by_one_rule(status: BeamStatus, valid: bool) -> None:
    assert status.count_valid == valid


BANDS = [
    (5.0, None, None, True),
    (5.0, 5.0, None, True),
    (4.9, 5.0, None, False),
    (5.0, None, 5.0, True),
    (5.1, None, 5.0, False),
    (0.0, -1.0, 1.0, True),
    (-1.1, -1.0, 1.0, False),
]
"""A live value, its band, and whether it is accepted."""


async def test_a_live_value_is_judged_alike_at_every_front_end() -> None:
    link = ScriptedLink(SNAPSHOT)
    app = app_of(link)
    async with app.run_test(size=(120, 40)) as pilot:
        for value, low, high, accepted in BANDS:
            live = LiveData.of(Live("gap", value, "mm", low, high, ""))
            publish(link, "live", state=S.EXECUTE, data=live.json_object())
            await painted(app, pilot, link)
            shown = app.screen.query_one("#band", StaticText).text.plain
            at_a_terminal = live_text(live)
            assert live.json_object()["accepted"] == accepted
            if (low, high) != (None, None):
                assert ("outside" in at_a_terminal) == ("OUT" in shown) == (not accepted), (value, low, high)
                assert ("ok" in at_a_terminal) == ("IN" in shown) == accepted
