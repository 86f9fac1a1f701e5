"""What is a message, and what becomes of anything else."""

import json
from contextlib import suppress

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from catseye.app.protocol.events import Unknown, Unread, passed_over_text
from catseye.app.protocol.message import MAX_LINE_BYTES, MessageError
from catseye.app.protocol.requests import Hello, Plain, decode_request
from catseye.app.protocol.run_events import PromptAsked
from catseye.app.tui.widgets.task_picture import task_picture
from catseye.procedures.kit.records import Json
from tests.unit.app.service.benches import ServiceBench, close, next_event, settled


@pytest.mark.parametrize(
    ("line", "text"),
    [
        (b"hold\n", "not JSON"),
        (b"\xff\xfe\n", "not JSON"),
        (b"\n", "not JSON"),
        (b"[" * 50_000, "not JSON"),
        (b"[1]\n", "a JSON object"),
        (b'{"id": 1, "op": "ping"}\n', "version null and this catseye speaks version 1"),
        (b'{"v": 2, "id": 1, "op": "ping"}\n', "version 2 and this catseye speaks version 1"),
        (b'{"v": true, "id": 1, "op": "ping"}\n', "version true and this catseye speaks version 1"),
        (b'{"v": 1, "id": 1, "op": "pong"}\n', "does not match any of the expected tags"),
        (b'{"v": 1, "id": 1}\n', "discriminator"),
        (b'{"v": 1, "op": "ping"}\n', "id"),
        (b'{"v": 1, "id": 1, "op": "ping", "more": 1}\n', "more"),
        (b'{"v": 1, "id": 1, "op": "override", "percent": "5"}\n', "percent"),
        (b'{"v": 1, "id": 1, "op": "override", "percent": NaN}\n', "percent"),
        (b'{"v": 1, "id": 1, "op": "hello", "client": "x", "who": "a\\nb"}\n', "who"),
        (b'{"v": 1, "id": 1, "op": "hello", "client": "x", "who": "\\u009b2J"}\n', "who"),
        (b'{"v": 1, "id": 1, "op": "hello", "client": "x", "who": "a\\u202eb"}\n', "who"),
        (b'{"v": 1, "id": 1, "op": "hello", "client": "x", "who": "\\ud800"}\n', "who"),
        (b'{"v": 1, "id": 1, "op": "start", "procedure": "x", "speed": 0}\n', "speed"),
    ],
)
def test_what_is_no_request_is_answered_with_the_reason(line: bytes, text: str) -> None:
    with pytest.raises(MessageError) as caught:
        decode_request(line)
    assert text in str(caught.value)


@given(st.binary(max_size=200) | st.text(max_size=200).map(str.encode))
@settings(max_examples=60)
def test_garbage_raises_one_kind_of_error(line: bytes) -> None:
    with pytest.raises(MessageError):
        decode_request(line)


_JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=10),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=8), inner, max_size=3),
    max_leaves=8,
)
OFFSET: dict[str, Json] = {
    "name": "offset",
    "value": 0.1,
    "unit": "mm",
    "low": None,
    "high": None,
    "accepted": True,
    "text": "",
}
_OPS = st.sampled_from(["hello", "control", "hand-over", "override", "start", "resume", "answer", "stop"])


@given(
    _OPS, st.dictionaries(st.sampled_from(["client", "who", "to", "percent", "text", "run"]), _JSON), _JSON
)
@settings(max_examples=60)
def test_wrong_fields_raise_nothing_else(op: str, fields: dict[str, object], number: object) -> None:
    line = json.dumps({"v": 1, "id": number, "op": op, **fields}).encode()
    with suppress(MessageError):
        assert decode_request(line)[1].op == op


async def test_garbage_is_answered_and_the_conversation_goes_on() -> None:
    async with ServiceBench().running() as bench:
        client = await bench.raw()
        client.write(b"garbage\n")
        assert (await client.read())["ok"] is False
        client.write(b'{"v": 7, "id": "x", "op": "stop"}\n')
        refused = await client.read()
        assert refused["re"] == "x"
        assert "version 7" in refused["error"]
        assert bench.control.ending is None
        assert (await client.ask("ping"))["ok"] is True
        close(client)


async def test_an_endless_line_is_refused_and_its_client_disconnected() -> None:
    async with ServiceBench().running() as bench, bench.client() as other:
        client = await bench.raw()
        client.write(b"x" * (3 * MAX_LINE_BYTES))
        [refused] = await client.rest()
        assert "longer than 65536 bytes" in refused["error"]
        assert (await other.request(Plain(op="ping")))["ok"] is True
        close(client)


async def test_without_hello_only_safety_requests_are_carried_out() -> None:
    async with ServiceBench().running() as bench:
        client = await bench.raw()
        assert "hello first" in (await client.ask("control"))["error"]
        assert (await client.ask("hold"))["ok"] is True
        assert bench.state() == "HOLDING"
        await settled()
        client.send("ping", 5)
        # No event of the hold came in between: events are for clients that are known.
        assert (await client.read())["re"] == 5
        close(client)


async def test_hello_is_answered_once_with_the_current_state() -> None:
    async with ServiceBench().running() as bench:
        bench.publish("run-started", procedure="script", title="Scripted")
        bench.publish("step-started", step="a", title="first", attempt=1)
        bench.publish("step-done", step="a", title="first", stored=False)
        bench.publish("step-started", step="b", title="second", attempt=1)
        bench.publish(
            "progress",
            done=1.0,
            total=4.0,
            text="x",
            elapsed_bench_s=1.0,
            left_bench_s=3.0,
            elapsed_s=1.0,
            left_s=3.0,
        )
        bench.publish("live", state="EXECUTE", data=OFFSET)
        bench.publish("prompt", id="door", kind="confirm", text="Close the door.", motion=False)
        async with bench.clients("Ada", "Ben") as (ada, ben):
            seen = ben.snapshot
            assert (seen.run, seen.procedure, seen.state) == ("run-1", "script", "EXECUTE")
            assert seen.simulated is True
            assert seen.prompt is not None
            assert seen.prompt.id == "door"
            assert seen.step is not None
            assert seen.step.title == "second"
            assert seen.progress is not None
            assert seen.progress.done == 1.0
            assert seen.live is not None
            assert seen.live.data.value == 0.1
            assert seen.control is None
            assert seen.engine.startswith("catseye ")
            assert seen.protocol == 1
            assert [each.who for each in seen.clients] == ["Ada", "Ben"]
            assert seen.you == ben.name != ada.name
            with pytest.raises(Exception, match="and once"):
                await ada.request(Hello(client="x", who="y"))


async def test_those_who_are_there_hear_who_comes_and_goes() -> None:
    async with ServiceBench().running() as bench, bench.client("Ada") as ada:
        async with bench.client("Ben") as ben:
            came = await next_event(ada, "clients")
            assert came["clients"] == ben.snapshot.json_object()["clients"]
        gone = await next_event(ada, "clients")
        assert gone["clients"] == [{"client": ada.name, "who": "Ada"}]


async def test_every_event_of_the_run_comes_with_the_version() -> None:
    async with ServiceBench().running() as bench:
        client = await bench.raw()
        assert (await client.ask("hello", client="x", who="Ada"))["ok"] is True
        bench.publish("warning", text="the beam is weak", data={})
        assert await client.read() == {
            "v": 1,
            "t": "now",
            "event": "warning",
            "run": "run-1",
            "text": "the beam is weak",
            "data": {},
        }  # fmt: skip - the event as it is on the line
        close(client)


@pytest.mark.parametrize(
    ("sent", "word"),
    [
        ({"event": "of-tomorrow", "anything": [1]}, "of-tomorrow"),
        ({"event": "prompt", "id": "a", "kind": "drawing", "text": "Draw."}, "asks something"),
        ({"event": "state", "state": "DREAMING"}, "cannot read"),
        (
            {"event": "control", "what": "inherited", "by": None, "before": None, "holder": None},
            "cannot read",
        ),
    ],
)
async def test_what_a_newer_engine_sends_cuts_no_client_off(sent: dict[str, object], word: str) -> None:
    async with ServiceBench().running() as bench, bench.client("Ada") as client:
        client.receive({"v": 1, "t": "now", "run": None, **sent})
        async for event in client.events():
            if isinstance(event, Unknown | Unread):
                break
        assert isinstance(event, Unknown | Unread)
        assert word in passed_over_text(event)
        # Whoever passes it on passes all of it on.
        assert event.json_object() == {"v": 1, "t": "now", "run": None, **sent}
        assert client.closed is None
        assert (await client.request(Plain(op="ping")))["ok"] is True


async def test_a_task_of_tomorrow_leaves_its_question_answerable() -> None:
    async with ServiceBench().running() as bench, bench.client("Ada") as client:
        asked = {
            "id": "polish",
            "kind": "confirm",
            "text": "Polish it.",
            "task": {"do": "polish", "with": "cloth"},
        }
        client.receive({"v": 1, "t": "now", "run": None, "event": "prompt", **asked})
        async for event in client.events():
            if isinstance(event, PromptAsked):
                break
        assert isinstance(event, PromptAsked)
        assert event.json_object()["task"] == {"do": "polish", "with": "cloth"}
        assert event.prompt.text == "Polish it."
        assert "polish: unknown here, of a newer engine" in task_picture(event.task)[0]
