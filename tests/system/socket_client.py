"""A client of an engine that is nothing but a socket."""

import json
import socket
from typing import Any

_LIMIT_S = 60


class Lines:
    """Sends a request a line, reads a message a line.

    Args:
        path: of the socket.
    """

    def __init__(self, path: str) -> None:
        self._socket = socket.socket(socket.AF_UNIX)
        self._socket.settimeout(_LIMIT_S)
        self._socket.connect(path)
        self._lines = self._socket.makefile("rb")

    def close(self) -> None:
        self._lines.close()
        self._socket.close()

    def ask(self, op: str, **fields: object) -> dict[str, Any]:
        self._socket.sendall(json.dumps({"v": 1, "id": op, "op": op, **fields}).encode() + b"\n")
        return self.until(re=op)

    def until(self, **fields: object) -> dict[str, Any]:
        for line in self._lines:
            message: dict[str, Any] = json.loads(line)
            if fields.items() <= message.items():
                return message
        raise AssertionError(f"the engine closed the connection before {fields}")
