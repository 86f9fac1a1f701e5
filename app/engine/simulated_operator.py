"""The hands of the emulated operator: they do on an emulated bench what a question asks for."""

import asyncio
import json
from collections.abc import Callable, Mapping

from catseye.app.errors import LinkFailedError
from catseye.procedures.kit.records import Json

_LIMIT_S = 10.0
"""Real seconds that one grip may take."""

_LONGEST_ANSWER_BYTES = 1 << 16

Task = Mapping[str, Json]
"""What is to be done; see `catseye.procedures.kit.context.Prompt`."""


class SimulatedOperator:
    """Turns screws and carries reflectors through the control port of an emulated bench.

    Args:
        endpoint: of the control port, `tcp://host:port`.
        clumsy: turn every screw the wrong way, as an operator may who looks at it from below.
    """

    def __init__(self, endpoint: str, *, clumsy: bool = False) -> None:
        self._endpoint = endpoint
        self._sense = -1.0 if clumsy else 1.0
        self._requests: dict[str, Callable[[Task], dict[str, Json]]] = {
            "turn-screw": self._turn,
            "place-reflector": lambda task: {"op": "place_reflector", "reflector": task["reflector"]},
            "clear-beam": lambda _task: {"op": "clear_beam"},
        }

    async def do(self, task: Task) -> dict[str, Json]:
        """Carry a task out.

        Returns:
            What was really asked of the bench.

        Raises:
            LinkFailedError: the bench does not answer, or cannot do it.
            ValueError: no hands know this task.
        """
        make = self._requests.get(str(task.get("do")))
        if make is None:
            raise ValueError(f"no hands know how to do {dict(task)}; they know {', '.join(self._requests)}")
        request = make(task)
        answer = await self._ask(request)
        if answer.get("ok") is not True:
            raise LinkFailedError(
                f"the emulated bench at {self._endpoint} refused {request}: {answer.get('error')}; put the cell "
                "file beside the emulator in order, or answer the question otherwise"
            )
        return request

    def _turn(self, task: Task) -> dict[str, Json]:
        turns = task["turns"]
        if not isinstance(turns, int | float):
            raise ValueError(f"turns of a screw are a number, found {turns!r}")
        return {"op": "turn_screw", "screw": task["screw"], "turns": self._sense * turns}

    async def _ask(self, request: Mapping[str, Json]) -> dict[str, Json]:
        host, _, port = self._endpoint.removeprefix("tcp://").rpartition(":")
        try:
            async with asyncio.timeout(_LIMIT_S):
                reader, writer = await asyncio.open_connection(host, int(port), limit=_LONGEST_ANSWER_BYTES)
                try:
                    writer.write(json.dumps(request).encode() + b"\n")
                    answer = json.loads(await reader.readline())
                finally:
                    writer.close()
                    await writer.wait_closed()
        except (OSError, TimeoutError, ValueError) as error:
            raise LinkFailedError(
                f"the emulated bench at {self._endpoint} ([tracker] of the cell file) does not do {request}: "
                f"{str(error) or 'no answer'}; is catseye emulate running with this cell file?"
            ) from error
        if not isinstance(answer, dict):
            raise LinkFailedError(f"{self._endpoint} is no control port of an emulated bench: {answer!r}")
        return answer
