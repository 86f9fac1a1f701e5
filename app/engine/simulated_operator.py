"""The hands of the emulated operator: they do on an emulated bench what a question asks for."""

import asyncio
import json
from collections.abc import Mapping
from urllib.parse import urlsplit

from catseye.app.errors import LinkFailedError
from catseye.procedures.kit.records import Json
from catseye.procedures.kit.tasks import ClearBeam, MountInterferometer, PlaceReflector, Task, TurnScrew

_LIMIT_S = 10.0
"""Real seconds that one grip may take."""

_LONGEST_ANSWER_BYTES = 1 << 16


class SimulatedOperator:
    """Turns screws, carries reflectors and remounts the interferometer through the control port of an emulated bench.

    Args:
        endpoint: of the control port, `tcp://host:port`.
        clumsy: turn every screw the wrong way, as an operator may who looks at it from below.
    """

    def __init__(self, endpoint: str, *, clumsy: bool = False) -> None:
        self._endpoint = endpoint
        self._sense = -1.0 if clumsy else 1.0

    async def do(self, task: Task) -> dict[str, Json]:
        """Carry a task out.

        Returns:
            What was really asked of the bench.

        Raises:
            LinkFailedError: the bench does not answer, or cannot do it.
        """
        request = self._request(task)
        answer = await self._ask(request)
        if answer.get("ok") is not True:
            raise LinkFailedError(
                f"the emulated bench at {self._endpoint} refused {request}: {answer.get('error')}; put the cell "
                "file beside the emulator in order, or answer the question otherwise"
            )
        return request

    def _request(self, task: Task) -> dict[str, Json]:
        match task:
            case TurnScrew():
                return {"op": "turn_screw", "screw": task.screw, "turns": self._sense * task.turns}
            case PlaceReflector():
                return {"op": "place_reflector", "reflector": task.reflector}
            case MountInterferometer():
                return {"op": "mount_interferometer", "turned_deg": task.turned_deg}
            case ClearBeam():
                return {"op": "clear_beam"}

    async def _ask(self, request: Mapping[str, Json]) -> dict[str, Json]:
        try:
            where = urlsplit(self._endpoint)
            async with asyncio.timeout(_LIMIT_S):
                reader, writer = await asyncio.open_connection(
                    where.hostname, where.port, limit=_LONGEST_ANSWER_BYTES
                )
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
