"""The way back into an interrupted run: what is compared, what is asked, and what the answers lead to."""

import asyncio
import signal
from pathlib import Path

import pytest

from catseye.app.engine.host import run_procedure
from catseye.app.engine.operator import Answer, Answerer
from catseye.app.engine.request import RunOutcome
from catseye.app.exitcode import ExitCode
from catseye.app.store.reader import RunReader
from catseye.app.store.run_store import RunStore
from catseye.drivers.roles.device import Identity
from catseye.drivers.roles.errors import AlarmError
from catseye.procedures.kit.context import Context, Prompt
from catseye.procedures.kit.records import Row
from tests.unit.app.engine.fakes import AWAY, FakeAir, FakeBench, FakeRobot, Script

CAUSE = "alarm 1: look under the arm"


class Desk:
    """A person who gives prepared answers and remembers the questions."""

    def __init__(self, **answers: str) -> None:
        self._answers = {name.replace("_", "/"): text for name, text in answers.items()}
        self.asked: list[Prompt] = []

    async def __call__(self, prompt: Prompt) -> Answer | None:
        self.asked.append(prompt)
        text = self._answers.get(prompt.id)
        return None if text is None else Answer(text, "Ada")


@pytest.fixture
def bench(tmp_path: Path) -> FakeBench:
    made = FakeBench(tmp_path / "runs")
    made.make_real()
    return made


async def run(
    bench: FakeBench,
    resume: Path | None = None,
    answerer: Answerer | None = None,
    procedure: Script | None = None,
) -> RunOutcome:
    request = bench.request(procedure or two_moves(), arm="lab-1", resume=resume, answerer=answerer)
    return await run_procedure(request, bench.build, bench.clock, bench.publish, bench.install)


def two_moves() -> Script:
    async def body(ctx: Context) -> None:
        for number in (0, 1):
            await ctx.step(f"p{number}", "a move", lambda: one(ctx))

    async def one(ctx: Context) -> Row:
        await ctx.move(AWAY)
        return {"resumed": ctx.resumed}

    return Script(body)


async def interrupted(bench: FakeBench) -> Path:
    """Return a run that an alarm aborted in its second step; the alarm is over."""

    async def body(ctx: Context) -> None:
        await ctx.step("p0", "a move", lambda: moved(ctx))
        bench.robot.move_error = AlarmError(CAUSE, 1)
        await ctx.step("p1", "a move", lambda: moved(ctx))

    async def moved(ctx: Context) -> Row:
        await ctx.move(AWAY)
        return {}

    outcome = await run(bench, procedure=Script(body))
    assert outcome.status == "aborted"
    bench.robot.move_error = None
    bench.robot.calls.clear()
    bench.published.clear()
    return outcome.path


async def stopped(bench: FakeBench) -> Path:
    """Return a run that its operator stopped after its first step."""

    async def body(ctx: Context) -> None:
        await ctx.step("p0", "a move", lambda: moved(ctx))
        bench.signal(signal.SIGINT)
        bench.signal(signal.SIGINT)
        await ctx.checkpoint()

    async def moved(ctx: Context) -> Row:
        await ctx.move(AWAY)
        return {}

    outcome = await run(bench, procedure=Script(body))
    assert outcome.status == "stopped"
    bench.robot.calls.clear()
    bench.published.clear()
    return outcome.path


async def test_an_aborted_run_continues_once_a_person_clears_it(bench: FakeBench) -> None:
    path, desk = await interrupted(bench), Desk(clear="yes", resume_reflectors="untouched")
    outcome = await run(bench, path, desk)
    assert outcome.status == "complete"
    assert [prompt.id for prompt in desk.asked] == ["clear", "resume/reflectors"]
    assert CAUSE in desk.asked[0].text
    assert all(prompt.motion for prompt in desk.asked)
    assert bench.states() == ["CLEARING", "STOPPED", "STARTING", "EXECUTE", "COMPLETE"]
    reader = RunReader(path)
    stored = [event.data["state"] for event in reader.events() if event.kind == "state"]
    assert stored[stored.index("ABORTED") + 1] == "CLEARING"
    assert [(p["id"], p["answer"], p["who"]) for p in reader.prompts()] == [
        ("clear", "yes", "Ada"),
        ("resume/reflectors", "untouched", "Ada"),
    ]
    assert [step.result for step in reader.steps()] == [{}, {"resumed": True}]
    assert bench.robot.calls.count("move") == 1


async def test_nothing_moves_before_the_answers(bench: FakeBench) -> None:
    path, seen = await interrupted(bench), []

    async def desk(prompt: Prompt) -> Answer | None:
        seen.append((prompt.id, list(bench.robot.calls)))
        return Answer("yes" if prompt.kind == "confirm" else "untouched", "Ada")

    await run(bench, path, desk)
    assert seen == [("clear", ["connect"]), ("resume/reflectors", ["connect"])]


@pytest.mark.parametrize(
    ("desk", "code"),
    [(Desk(clear="no"), ExitCode.SAFETY), (Desk(), ExitCode.TIMEOUT)],
    ids=["a person says no", "nobody is there"],
)
async def test_an_abort_that_is_not_cleared_is_asked_about_again(
    bench: FakeBench, desk: Desk, code: ExitCode
) -> None:
    path = await interrupted(bench)
    outcome = await run(bench, path, desk)
    assert outcome.exit_code == code
    assert "servo on" not in bench.robot.calls
    assert "move" not in bench.robot.calls
    assert "CLEARING" not in bench.states()
    later = Desk(clear="yes", resume_reflectors="untouched")
    assert (await run(bench, path, later)).status == "complete"
    assert CAUSE in later.asked[0].text


async def test_ctrl_c_ends_the_question_and_clears_nothing(bench: FakeBench) -> None:
    path = await interrupted(bench)
    asked = asyncio.Event()

    async def desk(_prompt: Prompt) -> Answer | None:
        asked.set()
        await asyncio.Event().wait()
        return None

    task = asyncio.create_task(run(bench, path, desk))
    await asked.wait()
    bench.signal(signal.SIGINT)
    outcome = await task
    assert (outcome.status, outcome.exit_code) == ("stopped", ExitCode.INTERRUPTED)
    assert "CLEARING" not in bench.states()
    later = Desk(clear="yes", resume_reflectors="untouched")
    assert (await run(bench, path, later)).status == "complete"
    assert [prompt.id for prompt in later.asked] == ["clear", "resume/reflectors"]


async def test_an_abort_cut_short_must_still_be_cleared(bench: FakeBench) -> None:
    path = await stopped(bench)
    store = await RunStore.reopen(path, bench.clock, reserve_bytes=0)
    await store.event("state", {"state": "ABORTING", "reason": "the door was opened"})
    await store.abandon()
    desk = Desk(clear="yes", resume_reflectors="untouched")
    assert (await run(bench, path, desk)).status == "complete"
    assert "the door was opened" in desk.asked[0].text


async def test_a_cleared_abort_is_not_asked_about_again(bench: FakeBench) -> None:
    path = await interrupted(bench)
    again = Desk(clear="yes")
    # Cleared, but nobody says what became of the reflectors.
    assert (await run(bench, path, again)).exit_code == ExitCode.TIMEOUT
    last = Desk(resume_reflectors="untouched")
    assert (await run(bench, path, last)).status == "complete"
    assert [prompt.id for prompt in last.asked] == ["resume/reflectors"]


async def test_moved_reflectors_end_the_run_before_anything_moves(bench: FakeBench) -> None:
    path, desk = await stopped(bench), Desk(resume_reflectors="moved")
    outcome = await run(bench, path, desk)
    assert (outcome.status, outcome.exit_code) == ("failed", ExitCode.REJECTED)
    assert "search again" in outcome.text
    assert "servo on" not in bench.robot.calls
    assert "move" not in bench.robot.calls
    reader = RunReader(path)
    assert [event.kind for event in reader.events()].count("reflectors-moved") == 1
    # The time is that of the last step: what was done before it may be distinguished from what was done after.
    assert reader.steps()[-1].done_utc[11:19] in desk.asked[0].text


async def test_a_stopped_run_needs_no_clear(bench: FakeBench) -> None:
    path, desk = await stopped(bench), Desk(resume_reflectors="untouched")
    assert (await run(bench, path, desk)).status == "complete"
    assert [prompt.id for prompt in desk.asked] == ["resume/reflectors"]
    assert bench.states()[0] == "STARTING"


async def test_questions_of_done_steps_are_not_asked_again(bench: FakeBench) -> None:
    lives = 0

    async def body(ctx: Context) -> None:
        await ctx.step("p0", "a question", lambda: asked(ctx, "first"))
        if lives == 1:
            bench.signal(signal.SIGINT)
            bench.signal(signal.SIGINT)
        await ctx.step("p1", "another one", lambda: asked(ctx, "second"))

    async def asked(ctx: Context, prompt_id: str) -> Row:
        return {"answer": await ctx.ask(Prompt(prompt_id, "text", "Say something."))}

    lives = 1
    before = Desk(first="one")
    outcome = await run(bench, None, before, Script(body))
    assert (outcome.status, [prompt.id for prompt in before.asked]) == ("stopped", ["first"])
    lives = 2
    after = Desk(resume_reflectors="untouched", second="two")
    assert (await run(bench, outcome.path, after, Script(body))).status == "complete"
    assert [prompt.id for prompt in after.asked] == ["resume/reflectors", "second"]
    assert [step.result for step in RunReader(outcome.path).steps()] == [{"answer": "one"}, {"answer": "two"}]


class OtherRobot(FakeRobot):
    """Another arm of the same model."""

    async def connect(self) -> Identity:
        await super().connect()
        return Identity("fake", "1.0", "8", self.simulated)


class OtherAir(FakeAir):
    """Another sensor."""

    async def connect(self) -> Identity:
        return Identity("another", "2.0", "9", self.simulated)


class SilentRobot(FakeRobot):
    """The same arm with a driver that does not report its serial number."""

    async def connect(self) -> Identity:
        await super().connect()
        return Identity("fake", "1.0", "", self.simulated)


async def test_another_robot_is_refused(bench: FakeBench) -> None:
    path = await stopped(bench)
    bench.robot = OtherRobot(bench.clock, simulated=False)
    outcome = await run(bench, path, Desk(resume_reflectors="untouched"))
    assert (outcome.status, outcome.exit_code) == ("failed", ExitCode.USAGE)
    assert "serial 8, was 7" in outcome.text
    assert "servo on" not in bench.robot.calls
    assert "move" not in bench.robot.calls


async def test_another_air_sensor_is_reported(bench: FakeBench) -> None:
    path = await stopped(bench)
    bench.air = OtherAir(bench.clock, simulated=False)
    outcome = await run(bench, path, Desk(resume_reflectors="untouched"))
    assert outcome.status == "complete"
    assert any("environment is not as it was" in str(event["text"]) for event in bench.said("warning"))


async def test_a_device_without_serial_number_counts_as_the_same(bench: FakeBench) -> None:
    path = await stopped(bench)
    bench.robot = SilentRobot(bench.clock, simulated=False)
    assert (await run(bench, path, Desk(resume_reflectors="untouched"))).status == "complete"


class Hands:
    """The emulated operator of a bench that may be started again."""

    def __init__(self) -> None:
        self.facts = {"bench_started": "one", "bench_truth": "this arm"}

    async def bench(self) -> dict[str, str]:
        return self.facts


@pytest.fixture
def emulated(tmp_path: Path) -> FakeBench:
    return FakeBench(tmp_path / "runs")


async def run_on_emulators(emulated: FakeBench, hands: Hands, resume: Path | None = None) -> RunOutcome:
    """Run two moves; the first life is stopped behind the first one."""

    async def body(ctx: Context) -> None:
        await ctx.step("p0", "a move", lambda: moved(ctx))
        if resume is None:
            emulated.signal(signal.SIGINT)
            emulated.signal(signal.SIGINT)
        await ctx.step("p1", "a move", lambda: moved(ctx))

    async def moved(ctx: Context) -> Row:
        await ctx.move(AWAY)
        return {}

    emulated.robot.calls.clear()
    request = emulated.request(Script(body), hands=hands, resume=resume)
    return await run_procedure(request, emulated.build, emulated.clock, emulated.publish, emulated.install)


async def test_an_emulated_arm_with_another_truth_is_refused(emulated: FakeBench) -> None:
    hands = Hands()
    path = (await run_on_emulators(emulated, hands)).path
    hands.facts = {"bench_started": "two", "bench_truth": "another arm"}
    outcome = await run_on_emulators(emulated, hands, path)
    assert (outcome.status, outcome.exit_code) == ("failed", ExitCode.USAGE)
    assert "the emulated arm is another one" in outcome.text
    assert "move" not in emulated.robot.calls


async def test_a_restarted_emulated_bench_is_reported(emulated: FakeBench) -> None:
    hands = Hands()
    path = (await run_on_emulators(emulated, hands)).path
    hands.facts = {**hands.facts, "bench_started": "two"}
    assert (await run_on_emulators(emulated, hands, path)).status == "complete"
    assert any("bench was restarted" in str(event["text"]) for event in emulated.said("warning"))
