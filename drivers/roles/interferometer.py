"""A length counter on a beam: its readings, its state, and when its count is valid."""

from abc import abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar, Literal, Protocol

from catseye.drivers.roles.device import Device, Role
from catseye.drivers.roles.text import DeviceText

Compensated = Literal["none", "instrument"]
"""Who corrects the lengths for the air: the program, or the instrument itself."""


@dataclass(frozen=True)
class LengthReading(DeviceText):
    """One reading of a length counter.

    Attributes:
        displacement_mm: displacement since the last zero, growing with the beam's length.
        raw: the instrument's own text or number, as it came.
        time_s: arrival, on the driver's clock, s.
        zero_id: number of the zero that it counts from; 0 before the first one.
    """

    displacement_mm: float
    raw: str
    time_s: float
    zero_id: int = 0


@dataclass(frozen=True)
class BeamStatus(DeviceText):
    """State of a length counter and its beam.

    Attributes:
        beam_ok: the beam returns now.
        beam_lost: latched since the last zero: the beam was interrupted.
        overspeed: latched since the last zero: the length changed faster than the counter counts.
        laser_ready: the laser is stable.
        signal: level of the returning beam, 0...1.
        signal_native: the level as the instrument states it, with its unit; empty when it states none.
        values_lost: latched since the last zero: values of a stream did not arrive. The count itself holds.
        zero_id: number of the last zero; 0 before the first one.
    """

    beam_ok: bool
    beam_lost: bool
    overspeed: bool
    laser_ready: bool
    signal: float
    signal_native: str = ""
    values_lost: bool = False
    zero_id: int = 0

    @property
    def interrupted(self) -> bool:
        """The beam does not return, or did not at some time since the last zero."""
        return self.beam_lost or not self.beam_ok

    @property
    def count_valid(self) -> bool:
        """The count has gone on since the last zero: beam kept, never too fast, laser stable."""
        return self.laser_ready and not self.overspeed and not self.interrupted

    def returns(self, signal_min: float) -> bool:
        """Return whether the beam returns now, and strongly enough to be measured with."""
        return self.beam_ok and self.signal >= signal_min


OnValue = Callable[[float, float], None]
"""Called with the arrival on the driver's clock, s, and the displacement since the zero, mm; must neither block nor
raise."""


class Interferometer(Device, Protocol):
    """A length counter on a beam."""

    role: ClassVar[Role] = "interferometer"

    @property
    @abstractmethod
    def compensated(self) -> Compensated:
        """Who corrects the lengths for the air."""
        ...

    @property
    def count_mm(self) -> float | None:
        """Displacement that 1 in the instrument's own number means, mm; None where the driver does not say.

        Negative where the number falls while the beam grows longer.
        """
        return None

    @property
    def streams(self) -> bool:
        """Values arrive without being asked for."""
        return False

    @property
    def numbers_values(self) -> bool:
        """Values of the stream are numbered: unless `values_lost` says so, none is missing."""
        return False

    def listen(self, on_value: OnValue | None) -> None:
        """Have every value of a stream shown; None ends that. Nothing is shown where nothing streams."""
        del on_value

    @abstractmethod
    async def zero(self) -> int:
        """Zero the count, clear the latches; return the new zero's number.

        Raises:
            RefusedError: no beam returns, and the instrument does not zero without one.
        """
        ...

    @abstractmethod
    async def read(self) -> LengthReading:
        """Return one reading.

        Raises:
            RefusedError: the instrument gives no value without a beam.
        """
        ...

    @abstractmethod
    async def status(self) -> BeamStatus:
        """Return the state of counter and beam."""
        ...


class StreamedInterferometer(Interferometer, Protocol):
    """A length counter whose values arrive without being asked for; call `_on_value` with each, if there is one."""

    _on_value: OnValue | None = None

    @property
    def streams(self) -> bool:
        """Values arrive without being asked for."""
        return True

    def listen(self, on_value: OnValue | None) -> None:
        """Have every value shown as it arrives; None ends that."""
        self._on_value = on_value
