"""The instrument beside a serial arm as those who watch see it: what it measures, and by which nests and targets."""

from catseye.app.protocol.bench import InstrumentStatus
from catseye.procedures.kit.bench import Bench
from catseye.procedures.serial_arm.bench import SerialBench


def instrument_of(bench: Bench) -> InstrumentStatus | None:
    """Return the instrument of a bench; None where it measures no targets of a serial arm."""
    if not isinstance(bench, SerialBench):
        return None
    instrument, able = bench.instrument, bench.instrument.abilities
    return InstrumentStatus(
        measures=(*(("points",) if able.points else ()), *(("poses",) if able.poses else ())),
        nests=tuple(nest.name for nest in instrument.nests),
        targets=tuple(target.name for target in bench.targets),
        base_mm=instrument.base_mm,
        base_deg=instrument.base_deg,
    )
