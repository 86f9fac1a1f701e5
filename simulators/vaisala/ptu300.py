"""ASCII interface of the PTU300 (sheet `modbus_env`, section 1b): SEND, R, S, INTV, FORM, UNIT, ERRS and others.

Commands end with CR (LF is taken, too), answers with CR LF. The emulator stands in the mode STOP; `R` begins
continuous output. Echo and prompt are off until `ECHO ON`. Not in the public documents and therefore this emulator's
own: the answers to INTV, to a wrong format and to an unknown command.
"""

import re
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta

from catseye.simulators.config import EmulatedDevice
from catseye.simulators.context import EmulationContext
from catseye.simulators.emulator import DeviceOptions, Emulator, NewSession, Note
from catseye.simulators.ports.session import Answer, Session
from catseye.simulators.vaisala.output_format import DEFAULT, Format, Value
from catseye.simulators.world.air import AirSample, dew_point_c
from catseye.simulators.world.air_probe import AirProbe
from catseye.simulators.world.timed_bench import TimedBench

VERSION = "PTU300 / 5.16"
LONGEST_CHARACTERS = 256

_QUANTITIES = frozenset({"P", "P1", "P2", "P3h", "T", "RH", "Td"})
_BEGAN = datetime(2026, 1, 1, tzinfo=UTC)
_PER_HPA = {
    "hPa": 1.0,
    "mbar": 1.0,
    "kPa": 0.1,
    "Pa": 100.0,
    "inHg": 0.02952999,
    "mmHg": 0.7500616,
    "torr": 0.7500616,
    "bara": 0.001,
    "barg": 0.001,
    "psia": 0.01450377,
    "psig": 0.01450377,
    "mmH2O": 10.19716,
    "inH2O": 0.4014631,
}
_SECONDS = {"S": 1.0, "MIN": 60.0, "H": 3600.0}
_MOST_LINES = 64


@dataclass
class Ptu300:
    """The instrument; all its clients share its settings.

    Attributes:
        probe: what it measures.
        bench: whose time its output follows.
        serial: serial number.
        address: on a line with several instruments.
        form: output format.
        metric: °C, otherwise °F.
        interval_s: of the continuous output, bench s.
        echo: commands are repeated and prompts are shown.
    """

    probe: AirProbe
    bench: TimedBench
    serial: str = "EMU00001"
    address: int = 0
    form: Format = field(default_factory=lambda: Format(DEFAULT, _QUANTITIES))
    pressure_unit: str = "hPa"
    metric: bool = True
    interval_s: float = 1.0
    echo: bool = False

    def line(self) -> str:
        """Return the present reading in the output format."""
        air = self.probe.sample()
        return self.form.fill(self._values(air), self._facts(air))

    def _facts(self, air: AirSample | None) -> dict[str, str]:
        """Return the modifiers of table 30: no heating, and no tendency, which takes three hours."""
        now = _BEGAN + timedelta(seconds=self.bench.time_s)
        return {
            "ADDR": f"{self.address:02d}",
            "SN": self.serial,
            "ERR": "0000" if air is not None else "1111",
            "OK": "OK" if air is not None else "  ",
            "STAT": "N 0    ",
            "TIME": f"{now:%H:%M:%S}",
            "DATE": f"{now:%Y-%m-%d}",
            "A3H": "*",
        }

    def _values(self, air: AirSample | None) -> dict[str, Value]:
        unit, temperature_unit = self.pressure_unit, "'C" if self.metric else "'F"
        # There is one transducer, and no trend.
        absent = {"P2": Value(None, unit), "P3h": Value(None, unit)}
        if air is None:
            units = {"P": unit, "P1": unit, "T": temperature_unit, "Td": temperature_unit, "RH": "%RH"}
            return absent | {name: Value(None, of) for name, of in units.items()}
        pressure = Value(air.pressure_hpa * _PER_HPA[unit], unit)
        dew_c = dew_point_c(air.temperature_c, air.humidity_percent)
        return absent | {
            "P": pressure,
            "P1": pressure,
            "T": Value(self._shown(air.temperature_c), temperature_unit),
            "Td": Value(self._shown(dew_c), temperature_unit),
            "RH": Value(air.humidity_percent, "%RH"),
        }

    def _shown(self, celsius: float) -> float:
        return celsius if self.metric else 1.8 * celsius + 32.0


class Ptu300Session(Session):
    """Conversation with one client.

    Args:
        note: called with each command.
    """

    def __init__(self, device: Ptu300, note: Callable[[str], None]) -> None:
        self._device = device
        self._note = note
        self._bytes = bytearray()
        self._lines: deque[str] = deque(maxlen=_MOST_LINES)
        self._next_s: float | None = None
        self._commands: dict[str, Callable[[str], str]] = {
            "SEND": self._send,
            "R": self._run,
            "S": self._stop,
            "INTV": self._interval,
            "FORM": self._form,
            "UNIT": self._unit,
            "ERRS": lambda _rest: "FAIL" if device.probe.sample() is None else "No errors",
            "?": lambda _rest: self._about(),
            "VERS": lambda _rest: f"{VERSION} EMULATOR",
            "SNUM": lambda _rest: f"Serial number  : {device.serial}",
            "OPEN": self._open,
            "CLOSE": lambda _rest: "line closed",
            "ECHO": self._set_echo,
        }

    def feed(self, data: bytes) -> None:
        """Take bytes, cut anywhere; of an endless line nothing is kept but that it is too long."""
        self._bytes += data
        while found := re.search(rb"[\r\n]", self._bytes):
            line = bytes(self._bytes[: found.start()]).decode("latin-1").strip()
            del self._bytes[: found.end()]
            if line:
                self._lines.append(line)
        del self._bytes[LONGEST_CHARACTERS:]

    def answer(self) -> Answer | None:
        """Carry out the next command."""
        if not self._lines:
            return None
        line = self._lines.popleft()
        self._note(line)
        word, _, rest = line.partition(" ")
        command = self._commands.get(word.upper())
        echoed = f"{line}\r\n" if self._device.echo else ""
        said = "Unknown command\r\n" if command is None else _ended(command(rest.strip()))
        prompt = ">" if self._device.echo else ""
        return f"{echoed}{said}{prompt}".encode("latin-1", "replace")

    def next_output_s(self) -> float | None:
        """Return when the next line of the continuous output is due."""
        return self._next_s

    def output(self) -> bytes:
        """Return the line that is due; lines missed long ago are left out."""
        now_s, step_s = self._device.bench.time_s, self._device.interval_s
        if self._next_s is None or now_s < self._next_s:
            return b""
        self._next_s += step_s * ((now_s - self._next_s) // step_s + 1.0)
        return self._device.line().encode("latin-1", "replace")

    def close(self) -> None:
        """End the continuous output."""
        self._next_s = None

    def _send(self, rest: str) -> str:
        if rest and rest != str(self._device.address):
            return ""
        return self._device.line()

    def _open(self, rest: str) -> str:
        if rest and rest != str(self._device.address):
            return ""
        return "PTU300: 1 line opened for operator commands"

    def _run(self, _rest: str) -> str:
        self._next_s = self._device.bench.time_s
        return ""

    def _stop(self, _rest: str) -> str:
        self._next_s = None
        return ""

    def _interval(self, rest: str) -> str:
        found = re.fullmatch(r"(\d{1,3})\s+(s|min|h)", rest, re.IGNORECASE)
        if found and int(found[1]):
            self._device.interval_s = int(found[1]) * _SECONDS[found[2].upper()]
        return f"Output interval: {self._device.interval_s:g} s"

    def _form(self, rest: str) -> str:
        if rest in {"", "?"}:
            return f"Output format  :{self._device.form.text.replace('#', chr(92))}"
        try:
            self._device.form = Format(DEFAULT if rest == "/" else rest, _QUANTITIES)
        except ValueError as error:
            return f"Format error: {error}"
        return "OK"

    def _unit(self, rest: str) -> str:
        words = rest.split()
        if words[:1] in (["m"], ["M"], ["n"], ["N"]):
            self._device.metric = words[0].upper() == "M"
        elif len(words) == 2 and words[0].upper() == "P":
            unit = next((name for name in _PER_HPA if name.lower() == words[1].lower()), None)
            if unit is None:
                return "Unknown unit"
            self._device.pressure_unit = unit
            return f"P units        : {unit}"
        return f"Output units   : {'metric' if self._device.metric else 'non metric'}"

    def _about(self) -> str:
        device = self._device
        return "\r\n".join(
            [
                VERSION,
                f"Serial number  : {device.serial}",
                "Batch number   : EMULATOR",
                "Module 1       : EMULATOR",
                f"Output format  : {device.form.text.replace('#', chr(92))}",
                f"Output interval: {device.interval_s:g} s",
                f"Address        : {device.address}",
                f"Echo           : {'ON' if device.echo else 'OFF'}",
                "Module 2       : EMULATOR",
            ]
        )

    def _set_echo(self, rest: str) -> str:
        if rest.upper() in {"ON", "OFF"}:
            self._device.echo = rest.upper() == "ON"
        return f"Echo           : {'ON' if self._device.echo else 'OFF'}"


def _ended(text: str) -> str:
    """Return a text with its line end; a line of an output format brings its own."""
    return text if not text or text.endswith(("\r", "\n")) else f"{text}\r\n"


class VaisalaAscii(Emulator):
    """An instrument that all its clients share."""

    role = "environment"

    class Options(DeviceOptions):
        """Options.

        Attributes:
            address: on a line with several instruments.
        """

        address: int = 0

    @classmethod
    def sessions(cls, context: EmulationContext, device: EmulatedDevice, note: Note) -> NewSession:
        """Make the instrument that all clients share."""
        ptu300 = Ptu300(context.air.of(device.name), context.bench, address=cls.Options.of(device).address)
        return lambda: Ptu300Session(ptu300, note)
