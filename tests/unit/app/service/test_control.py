"""Who steers a run, and what becomes of it when that client is lost."""

from dataclasses import replace
from typing import cast

import pytest

from catseye.app.errors import SafetyError
from catseye.app.protocol.answers import Answer
from catseye.app.protocol.engine_events import Client
from catseye.app.protocol.loss import LossPolicy
from catseye.app.protocol.requests import HandOver, Override, Plain, decode_request, request_of
from catseye.app.protocol.state import ControlState
from catseye.app.service.errors import RefusedError, ServiceError
from catseye.app.service.request_handler import Engine, RequestHandler
from tests.unit.app.engine.fakes import HOME
from tests.unit.app.service.benches import ServiceBench, close, next_event, settled


async def test_control_changes_hands_and_everyone_is_notified() -> None:
    async with ServiceBench().running() as bench, bench.clients("Ada", "Ben") as (ada, ben):
        await ada.take_control()
        taken = await next_event(ben, "control", what="taken")
        assert taken["by"] == f"Ada ({ada.name})"
        with pytest.raises(RefusedError, match=r"Ada .* holds control"):
            await ben.take_control()
        await ben.take_control(force=True)
        assert (await next_event(ada, "control", what="taken by force"))["by"] == f"Ben ({ben.name})"
        with pytest.raises(RefusedError, match="needs control"):
            await ada.release()
        await ben.request(HandOver(to=ada.name))
        await ada.release()
        assert [note["what"] for note in bench.noted("control")] == [
            "taken",
            "taken by force",
            "handed over",
            "released",
        ]  # fmt: skip - one sequence
        assert bench.noted("client-lost") == []


async def test_control_is_handed_to_clients_that_are_there_only() -> None:
    async with ServiceBench().running() as bench, bench.client() as ada:
        await ada.take_control()
        with pytest.raises(RefusedError, match=f"there is no client 'ghost'; there are {ada.name}"):
            await ada.request(HandOver(to="ghost"))
        assert bench.registry.lease.holder is not None


async def test_control_handed_over_to_oneself_is_no_change() -> None:
    async with ServiceBench().running() as bench, bench.client("Ada") as ada:
        await ada.take_control()
        await ada.request(HandOver(to=ada.name))
        assert [note["what"] for note in bench.noted("control")] == ["taken"]


async def test_the_console_holds_control_until_it_is_taken_by_force() -> None:
    async with ServiceBench().running() as bench, bench.client("Ben") as ben:
        bench.registry.lease.console = "Ada"
        with pytest.raises(RefusedError, match=r"Ada \(console\) holds control"):
            await ben.take_control()
        await ben.take_control(force=True)
        assert bench.noted("control")[0]["before"] == "Ada (console)"
        await ben.release()
        assert bench.registry.snapshot().control == Client(client="console", who="Ada")


@pytest.mark.parametrize("op", ["unhold", "clear", "release"])
async def test_what_steers_needs_control(op: str) -> None:
    async with ServiceBench().running() as bench, bench.client() as client:
        with pytest.raises(RefusedError, match="needs control"):
            await client.request(request_of({"op": op}))
        assert bench.state() == "EXECUTE"


@pytest.mark.parametrize(
    ("op", "fields"),
    [
        ("answer", {"prompt": "p", "text": "yes"}),
        ("override", {"percent": 5.0}),
        ("start", {"procedure": "open-loop"}),
        ("resume", {"run": "x"}),
        ("hand-over", {"to": "test-1"}),
    ],
)
async def test_what_steers_with_words_needs_control(op: str, fields: dict[str, str | float]) -> None:
    async with ServiceBench().running() as bench, bench.client() as client:
        with pytest.raises(RefusedError, match="needs control"):
            await client.request(request_of({"op": op, **fields}))


@pytest.mark.parametrize(
    ("op", "states"),
    [("hold", ["HOLDING"]), ("stop", ["STOPPING", "STOPPED"]), ("abort", ["ABORTING", "ABORTED"])],
)
async def test_anybody_may_make_it_safe(op: str, states: list[str]) -> None:
    async with ServiceBench().running() as bench, bench.clients("Ada", "Ben") as (ada, ben):
        await ada.take_control()
        await ben.request(request_of({"op": op}))
        for state in states:
            event = await next_event(ada, "state", state=state)
        assert op == "hold" or bench.robot.calls == ["stop"]
        assert "Ben" in str(event["reason"]) or event["state"] in {"STOPPED", "ABORTED"}


async def test_a_held_run_goes_on_for_whoever_has_control() -> None:
    async with ServiceBench().running() as bench, bench.client() as client:
        await client.take_control()
        with pytest.raises(RefusedError, match="not held, it is in state EXECUTE"):
            await client.request(Plain(op="unhold"))
        await client.request(Plain(op="hold"))
        await client.request(Plain(op="hold"))
        await client.request(Plain(op="unhold"))
        assert bench.state() == "EXECUTE"


async def test_a_hold_before_anything_moves_is_refused_with_the_reason() -> None:
    async with ServiceBench().running(ControlState.STARTING) as bench, bench.client() as client:
        with pytest.raises(RefusedError, match="nothing moves"):
            await client.request(Plain(op="hold"))
        await client.request(Plain(op="stop"))
        await bench.control.halted()
        with pytest.raises(RefusedError, match="has ended"):
            await client.request(Plain(op="stop"))


async def test_an_aborted_run_awaiting_clearance_can_be_stopped() -> None:
    bench = ServiceBench()
    with bench.registry.running(bench.handle):
        async with bench.client() as client:
            with pytest.raises(RefusedError, match="nothing moves"):
                await client.request(Plain(op="hold"))
            await client.request(Plain(op="stop"))
            assert bench.state() == "STOPPED"
        await bench.server.end()


@pytest.mark.parametrize(("policy", "state"), [("continue", "EXECUTE"), ("hold", "HOLDING")])
async def test_losing_a_client_before_its_run_opens_applies_the_policy(
    policy: LossPolicy, state: str
) -> None:
    bench = ServiceBench()
    bench.registry.policy, bench.registry.beginning = policy, True
    async with bench.client("Ada") as ada:
        await ada.take_control()
    await settled()
    async with bench.running():
        await settled()
        assert bench.state() == state
        assert bench.noted("client-lost")[0]["who"] == "Ada"
        assert len(bench.warnings) == (policy == "continue")
        assert bench.robot.calls == []


async def test_a_session_that_fails_has_lost_its_client(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    async with ServiceBench().running() as bench, bench.client("Ada") as ada:
        await ada.take_control()
        monkeypatch.setattr(bench.gate, "want_override", lambda _percent: 1 // 0)
        with pytest.raises(ServiceError):
            await ada.request(Override(percent=5.0))
        await settled()
        assert bench.state() == "HOLDING"
        assert bench.noted("client-lost")[0]["reason"] == "its session failed"
    assert "session failed" in caplog.text


async def test_a_run_that_serves_itself_starts_and_clears_nothing() -> None:
    async with ServiceBench().running() as bench, bench.client() as client:
        await client.take_control()
        for op in ("clear", "shutdown"):
            with pytest.raises(RefusedError, match="serves one run"):
                await client.request(request_of({"op": op}))


@pytest.mark.parametrize(
    ("policy", "state"), [("continue", "EXECUTE"), ("hold", "HOLDING"), ("stop", "STOPPED")]
)
async def test_a_lost_client_with_control_means_what_the_cell_says(policy: LossPolicy, state: str) -> None:
    async with ServiceBench().running() as bench, bench.client("Ben") as ben:
        bench.registry.policy = policy
        async with bench.client("Ada") as ada:
            await ada.take_control()
        lost = await next_event(ben, "client-lost")
        await settled()
        assert bench.state() == state
        assert bench.noted("client-lost") == [
            {"client": "test-2", "who": "Ada", "reason": "it closed the connection", "policy": policy}
        ]
        assert lost["policy"] == policy
        assert len(bench.warnings) == (policy == "continue")
        assert (bench.robot.calls == ["stop"]) == (policy == "stop")
        if policy == "hold":
            await ben.take_control()
            await ben.request(Plain(op="unhold"))
            assert bench.state() == "EXECUTE"


async def test_losing_a_client_while_starting_holds_the_run_once_started() -> None:
    async with ServiceBench().running(ControlState.STARTING) as bench:
        async with bench.client("Ada") as ada:
            await ada.take_control()
        await settled()
        assert bench.state() == "STARTING"
        bench.control.started()
        await settled()
        assert bench.state() == "HOLDING"
        # It is held once: whoever lets it go on is there.
        bench.control.unhold("Ben")
        await settled()
        assert bench.state() == "EXECUTE"


@pytest.mark.parametrize("broken", ["by hand", "record"])
async def test_losing_a_client_holds_the_run_despite_other_failures(
    broken: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with ServiceBench().running() as bench:
        async with bench.client("Ada") as ada:
            await ada.take_control()
            if broken == "by hand":
                monkeypatch.setattr(bench.registry, "on_control", lambda: 1 // 0)
            else:
                monkeypatch.setattr(bench.handle, "note", None)
        await settled()
        assert bench.state() == "HOLDING"


@pytest.mark.parametrize(("op", "state"), [("stop", "STOPPING"), ("abort", "ABORTING")])
async def test_a_stop_reaches_the_run_whatever_is_broken_beside_it(op: str, state: str) -> None:
    async with ServiceBench().running() as bench:
        # An engine without a single part.
        handler = RequestHandler(bench.registry, cast(Engine, object()))
        _, request = decode_request(f'{{"v":1,"id":1,"op":"{op}"}}'.encode())
        assert handler.take(None, request) == Answer()
        assert bench.state() == state


async def test_a_watcher_and_one_who_gave_control_back_may_vanish() -> None:
    async with ServiceBench().running() as bench:
        async with bench.clients("Ada", "Ben") as (ada, _):
            await ada.take_control()
            await ada.release()
        await settled()
        assert bench.state() == "EXECUTE"
        assert bench.noted("client-lost") == []


async def test_only_a_silent_client_with_control_is_lost() -> None:
    async with ServiceBench().running() as bench, bench.client("Ben") as ben:
        silent = await bench.raw()
        assert (await silent.ask("hello", client="mute", who="Ada"))["ok"]
        assert (await silent.ask("control"))["ok"]
        for _ in range(4):
            # Ben's client pings by itself.
            bench.clock.advance(2.0)
            await settled(50)
        assert bench.state() == "EXECUTE"
        bench.clock.advance(2.5)
        await settled()
        assert bench.state() == "HOLDING"
        assert bench.noted("client-lost")[0]["reason"] == "it said nothing for 10 s"
        await ben.take_control()
        for _ in range(20):
            bench.clock.advance(2.0)
            await settled(50)
        assert len(bench.noted("client-lost")) == 1
        close(silent)


async def test_the_end_of_a_run_loses_nobody() -> None:
    bench = ServiceBench()
    async with bench.running(), bench.client("Ada") as ada:
        await ada.take_control()
        bench.control.done()
        await bench.server.end()
    assert bench.noted("client-lost") == []


async def test_an_override_is_lowered_at_the_next_motion_only() -> None:
    async with ServiceBench().running() as bench, bench.client() as client:
        await client.take_control()
        for percent in (20.0, 50.0):
            with pytest.raises(RefusedError, match="only ever lowered"):
                await client.request(Override(percent=percent))
        assert (await client.request(Override(percent=8.0)))["until_the_next_motion"] == 20.0
        assert bench.robot.calls == []
        await bench.gate.require(HOME)
        assert bench.robot.calls == ["override 8"]
        with pytest.raises(RefusedError, match="the override is 8 %"):
            await client.request(Override(percent=8.0))


async def test_an_override_raised_elsewhere_is_lowered_and_read_back() -> None:
    bench = ServiceBench()
    lowered: list[float] = []
    bench.gate.on_override = lowered.append
    bench.gate.want_override(8.0)
    for _ in range(2):
        await bench.gate.require(HOME)
        bench.robot.state = replace(bench.robot.state, override_percent=15.0)
    await bench.gate.require(HOME)
    assert bench.robot.calls == ["override 8"] * 3
    assert lowered == [8.0] * 3
    bench.gate.want_override(5.0)
    bench.robot.overrides = [6.0]
    with pytest.raises(SafetyError, match="asked for an override of 5 % and reads 6 %"):
        await bench.gate.require(HOME)


async def test_an_override_waits_for_the_devices() -> None:
    async with ServiceBench().running() as bench, bench.client() as client:
        bench.handle.gate = None
        await client.take_control()
        with pytest.raises(RefusedError, match="not ready yet"):
            await client.request(Override(percent=8.0))
