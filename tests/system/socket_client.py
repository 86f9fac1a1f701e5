"""A client of an engine that is nothing but a socket."""

import json
import socket
from typing import Any

from tests.patience import HANG_S


class Lines:
    """Sends a request a line, reads a message a line.

    Args:
        path: of the socket.
    """

    def __init__(self, path: str) -> None:
        self._socket = socket.socket(socket.AF_UNIX)
        self._socket.settimeout(HANG_S)
        self._socket.connect(path)
        self._lines = self._socket.makefile("rb")

    def close(self) -> None:
        """Disconnect."""
        self._lines.close()
        self._socket.close()

    def send(self, op: str, **fields: object) -> None:
        """Put a request whose answer `until` may wait for."""
        self._socket.sendall(json.dumps({"v": 1, "id": op, "op": op, **fields}).encode() + b"\n")

    def ask(self, op: str, **fields: object) -> dict[str, Any]:
        """Put a request and return its answer; events before it are passed over."""
        self.send(op, **fields)
        return self.until(re=op)

    def until(self, **fields: object) -> dict[str, Any]:
        """Wait for a message with these fields."""
        for line in self._lines:
            message: dict[str, Any] = json.loads(line)
            if fields.items() <= message.items():
                return message
        raise AssertionError(f"the engine closed the connection before {fields}")
