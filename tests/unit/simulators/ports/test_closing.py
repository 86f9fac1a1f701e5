"""Whoever came in the moment in which a server closes is served or sent away, never left hanging."""

import asyncio
import socket
from pathlib import Path

import pytest

from catseye.simulators.ports.tcp import close_server


@pytest.mark.parametrize("turns", range(6))
async def test_nobody_is_left_hanging_by_a_server_that_closes(tmp_path: Path, turns: int) -> None:
    served: list[asyncio.StreamWriter] = []
    path = tmp_path / "s"
    server = await asyncio.start_unix_server(lambda _, writer: served.append(writer), path)
    with socket.socket(socket.AF_UNIX) as peer:
        peer.connect(str(path))
        peer.setblocking(False)
        for _ in range(turns):
            await asyncio.sleep(0)
        await close_server(server)
        for writer in served:
            writer.transport.abort()
        await asyncio.sleep(0)
        # An end, or a reset: a connection that nobody closes would have nothing to read.
        try:
            assert peer.recv(1) == b""
        except ConnectionResetError:
            assert not served
