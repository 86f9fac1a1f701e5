"""An emulated bench that somebody else runs, for one check: prepared by its control port, left as it was."""

import math
from collections.abc import Iterator
from contextlib import contextmanager

from catseye.app.testing.bench import RunningBench
from catseye.drivers.roles.device import Role

_SIDES = (1.0, -2.0)
"""A reflector that is missed is pushed to one side, and past its place to the other one if that was wrong."""


@contextmanager
def borrowed_bench(control: str, role: Role) -> Iterator[RunningBench]:
    """Yield a bench without faults; for a length counter its beam returns.

    Args:
        control: endpoint of its control port.
        role: of the device that is examined.

    Raises:
        RuntimeError: nobody answers there, or its beam hits nothing.
    """
    bench = RunningBench({}, control)
    try:
        bench.clear_faults()
    except OSError as error:
        raise RuntimeError(f"no control port answers at {control}: {error}: start the bench first") from error
    way_mm = _catch_beam(bench) if role == "interferometer" else 0.0
    try:
        yield bench
    finally:
        bench.clear_faults()
        if way_mm:
            _push_aside(bench, -way_mm)


def _catch_beam(bench: RunningBench) -> float:
    """Push the nearest reflector into the beam unless one returns it; return how far, mm."""
    beam, way_mm = bench.state().beam, 0.0
    if beam.returns:
        return 0.0
    for side in _SIDES:
        _push_aside(bench, side * beam.miss_mm)
        way_mm += side * beam.miss_mm
        if bench.state().beam.returns:
            return way_mm
    _push_aside(bench, -way_mm)
    raise RuntimeError(f"the beam of the bench misses {beam.nearest} by {beam.miss_mm:.1f} mm: move its arm")


def _push_aside(bench: RunningBench, by_mm: float) -> None:
    """Push the nearest reflector across the beam."""
    beam = bench.state().beam
    way_rad = math.radians(beam.direction_deg)
    way = {"dx_mm": -by_mm * math.sin(way_rad), "dy_mm": by_mm * math.cos(way_rad)}
    bench.fault("move_reflector", reflector=beam.nearest, **way)
