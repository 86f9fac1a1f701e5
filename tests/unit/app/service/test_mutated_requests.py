"""Whatever a client sends is answered, moves nothing, and costs no memory; the conversation goes on."""

import tracemalloc

from catseye.app.protocol.message import MAX_LINE_BYTES
from tests.fuzz.amount import FILES, source, tell
from tests.fuzz.requests import hostile_line
from tests.unit.app.engine.fakes import HOME
from tests.unit.app.service.benches import RawClient, ServiceBench, close

LINES = 8 * FILES
MOST_HELD_BYTES = 500_000


async def _hear(client: RawClient, lines: list[bytes]) -> int:
    """Send lines; return how many were refused, each by a sentence."""
    refused = 0
    for line in lines:
        client.write(line)
        answer = await client.read()
        while "ok" not in answer:
            answer = await client.read()
        if not answer["ok"]:
            refused += 1
            assert answer["error"]
            assert len(answer["error"]) < 5000
    return refused


async def test_hostile_requests_are_answered_and_move_nothing() -> None:
    numbers = source("requests")
    # A longer one ends its connection, which other tests see to.
    lines = [line for line in (hostile_line(numbers) for _ in range(LINES)) if len(line) < MAX_LINE_BYTES]
    async with ServiceBench().running() as bench, bench.client("Ada") as ada:
        await ada.take_control()
        client = await bench.raw()
        assert (await client.ask("hello", client="hostile", who="Eve"))["ok"] is True
        refused = await _hear(client, lines[::2])
        tracemalloc.start()
        try:
            refused += await _hear(client, lines[1::2])
            held, _ = tracemalloc.get_traced_memory()
        finally:
            tracemalloc.stop()
        assert held < MOST_HELD_BYTES
        assert bench.robot.pose == HOME
        assert not bench.robot.overrides
        assert not [call for call in bench.robot.calls if call.startswith("move")]
        close(client)
    tell(f"engine: {len(lines)} hostile requests, {refused} refused")
