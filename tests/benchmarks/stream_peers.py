"""What the stream benchmark listens to, a process of its own: it prints its endpoint and streams until it is ended.

`emitter`: a bare socket that writes one uMD line each millisecond and puts the moment of writing, µs of the system's
monotonic clock, into LOWDATA. `emulator ENDPOINT`: the emulated uMD2 with 1000 samples a second.
"""

import asyncio
import socket
import sys
import time

from catseye.simulators.config import EmulatedDevice, EmulationConfig, ErrorBudget, ReflectorPlace
from catseye.simulators.emulated_bench import EmulatedBench

RATE_HZ = 1000


def emit() -> None:
    """Serve one client."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        _say(f"tcp://127.0.0.1:{server.getsockname()[1]}")
        client, _ = server.accept()
    client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    start_s = time.monotonic()
    sequence = 0
    with client:
        while True:
            time.sleep(max(0.0, start_s + sequence / RATE_HZ - time.monotonic()))
            sent_us = time.monotonic_ns() // 1000
            client.sendall(f"1500 1500 {sequence} 1 0 {sequence} 101 {sent_us}\r\n".encode())
            sequence += 1


async def emulate(endpoint: str) -> None:
    """Serve the emulated display."""
    config = EmulationConfig(
        reflectors=(ReflectorPlace("P2", 680.0, 0.0),),
        devices=(EmulatedDevice("umd", "umd", endpoint, {"rate_hz": RATE_HZ}),),
        budget=ErrorBudget.none(),
    )
    async with EmulatedBench(config) as bench:
        _say(bench.endpoints[0].endpoint)
        await asyncio.Event().wait()


def _say(endpoint: str) -> None:
    sys.stdout.write(f"{endpoint}\n")
    sys.stdout.flush()


if __name__ == "__main__":
    if sys.argv[1] == "emitter":
        emit()
    else:
        asyncio.run(emulate(sys.argv[2]))
