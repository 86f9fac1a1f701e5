"""A continuous measurement of the emulated tracker: points at equal times or distances, several a packet."""

import math

from catseye.simulators.leica import packets, parameters
from catseye.simulators.leica.packets import PointValues
from catseye.simulators.leica.server import Server
from catseye.simulators.survey import Place

PACKET_S = 1.0 / 3.0
"""From one packet to the next, bench time."""

_LOOK_S = 0.02
"""How often it is looked how far the target has gone."""

_MOST_POINTS = 500
"""Of a packet."""


class Stream:
    """A measurement under way.

    Args:
        server: whose clients have set what is measured.

    Attributes:
        due_s: bench time of the next packet.
        ended: all points are measured, or the beam was broken.
        broken: it was.
    """

    def __init__(self, server: Server) -> None:
        self._server = server
        self._mode = int(server.kept[parameters.MODE][0])
        timed = self._mode == parameters.TIME_MODE
        block = server.kept[parameters.CONTINUOUS_TIME if timed else parameters.CONTINUOUS_DISTANCE]
        self._step_s = 1e-3 * block[0] if timed else _LOOK_S
        self._step_mm = 0.0 if timed else server.instrument.units.to_mm(block[0])
        self._left = int(block[1]) or None
        self._began_s = server.now_s
        self._last_mm: Place | None = None
        self._points: list[tuple[float, PointValues]] = []
        self.due_s = server.now_s + PACKET_S
        self.ended = self.broken = False
        self._plan(server.now_s)

    def stop(self) -> None:
        """Measure no more."""
        self.ended = True

    def packet(self) -> bytes:
        """Return the points since the last packet; empty without any."""
        points, self._points = self._points[:_MOST_POINTS], self._points[_MOST_POINTS:]
        self.due_s = self._server.now_s + PACKET_S
        if not points:
            return b""
        extended = bool(self._server.kept[parameters.STATISTIC][1])
        return packets.multi(self._mode, points, self._server.instrument.air(), extended=extended)

    def _plan(self, time_s: float) -> None:
        self._server.instrument.bench.call_at(
            time_s + self._step_s, lambda: self._look(time_s + self._step_s)
        )

    def _look(self, time_s: float) -> None:
        if self.ended:
            return
        instrument = self._server.instrument
        if not instrument.locked:
            self.ended = self.broken = True
            return
        here_mm = instrument.glance_mm if self._step_mm else None
        if here_mm is None or self._last_mm is None or math.dist(self._last_mm, here_mm) >= self._step_mm:
            self._take(time_s, here_mm)
        if self._left == 0:
            self.ended = True
        else:
            self._plan(time_s)

    def _take(self, time_s: float, here_mm: Place | None) -> None:
        point = self._server.instrument.measure(min(self._step_s, _LOOK_S))
        if point is None or len(self._points) >= 10 * _MOST_POINTS:
            return
        self._last_mm = here_mm
        self._points.append((time_s - self._began_s, point))
        if self._left is not None:
            self._left -= 1
