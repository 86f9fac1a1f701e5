"""Lines of the uMD displays: integers separated by blanks, 8 for one axis, 16 for three. Pure."""

import re
from dataclasses import dataclass

FIRMWARE = 10
"""LOWCODE of the firmware's number."""

NOTHING = 0
"""LOWCODE without meaning."""

CYCLE = 32
"""Samples in which all LOWCODEs come once."""

EMULATOR_MARK = 0x454D554C
"""LOWDATA of an emulator where LOWCODE has no meaning: the letters EMUL."""

MAX_LINE_BYTES = 512
_NUMBER = re.compile(rb"[+-]?\d{1,20}")
_PHASES = 256.0
_WRAPS = frozenset(2**bits - 1 for bits in (8, 15, 16, 24, 31, 32))


@dataclass(frozen=True, slots=True)
class Axis:
    """One measured axis.

    Attributes:
        measured: frequency of its signal; 0 without a beam.
        displacement: count of half wavelengths over the optics' multiplier.
        velocity: counts a sample.
        phase: fraction of a count in 1/256.
    """

    measured: int
    displacement: int
    velocity: int
    phase: int

    @property
    def counts(self) -> float:
        """The displacement with its fraction."""
        return self.displacement + self.phase / _PHASES


@dataclass(frozen=True, slots=True)
class Sample:
    """One line.

    Attributes:
        reference: frequency of the reference; 0 without the laser.
        sequence: number of the sample.
        low_code: what low_data is.
        low_data: a slow value, another one in each of 32 samples.
        axes: one or three.
    """

    reference: int
    sequence: int
    low_code: int
    low_data: int
    axes: tuple[Axis, ...]


class SampleDecoder:
    """Cuts samples out of a stream that may begin in the middle of a line.

    Attributes:
        discarded_lines: lines that were no sample.
    """

    def __init__(self) -> None:
        self._rest = b""
        self.discarded_lines = 0

    def feed(self, data: bytes) -> list[Sample]:
        """Take a chunk; return the samples that are complete now."""
        *lines, self._rest = (self._rest + data).replace(b"\r", b"\n").split(b"\n")
        if len(self._rest) > MAX_LINE_BYTES:
            self._rest = b""
            self.discarded_lines += 1
        samples: list[Sample] = []
        for line in filter(None, lines):
            sample = parse_sample(line)
            if sample is None:
                self.discarded_lines += 1
            else:
                samples.append(sample)
        return samples


def parse_sample(line: bytes) -> Sample | None:
    """Read a line without its end; None when it is no sample."""
    fields = line.split()
    if len(fields) not in {8, 16} or not all(map(_NUMBER.fullmatch, fields)):
        return None
    numbers = [int(field) for field in fields]
    reference, measured, displacement, velocity, phase, sequence, low_code, low_data = numbers[:8]
    axes = [Axis(measured, displacement, velocity, phase)]
    axes += [Axis(*numbers[at : at + 4]) for at in range(8, len(numbers), 4)]
    return Sample(reference, sequence, low_code, low_data, tuple(axes))


def missing(last: int, sequence: int) -> int | None:
    """Return how many samples are missing between two numbers; None when the display has started anew."""
    if sequence > last:
        return sequence - last - 1
    return 0 if sequence == 0 and last in _WRAPS else None
