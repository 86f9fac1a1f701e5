"""The IDS behind its methods: modes, one axis on the bench's beam, environment unit, pilot laser.

Names, modes and the layout of results come from the sheet. Not known, and assumed here: the numbers and texts of
errors (all say EMULATOR), how long a start takes, that an interrupted axis shows its error until `resetError`, a
reset of the axis or a restart, and the layout of the older `getSignalQuality` (like the newer one). Averaging is
remembered and has no effect. The environment unit's index is Edlén's of helium-neon light, as the bench has it. Every
start finds the absolute length anew, with an error that stays until the next one.
"""

from collections.abc import Callable
from typing import Literal

import numpy as np
from pydantic import Field

from catseye.calibration.air import HE_NE_VACUUM_NM, refractive_index
from catseye.simulators.lengths import LengthOptions, Lengths
from catseye.simulators.world.air import AirSample
from catseye.simulators.world.air_probe import AirProbe
from catseye.simulators.world.counter import Reading
from catseye.simulators.world.instrument import Instrument

PM_PER_MM = 1e9
_INDEX_DECIMALS = 9
AXES = (0, 1, 2)

IDLE = "system idle"
RUNNING = "measurement running"
ALIGNING = "optics alignment running"
PILOT = "pilot laser enabled"
_STARTING = {RUNNING: "measurement starting", ALIGNING: "optics alignment starting"}

_TEXTS = {
    0: "no error",
    1: "beam interrupted",
    2: "not possible in this mode",
    3: "parameter out of range",
    4: "no signal on this axis",
    5: "environment unit does not measure",
}
_INTERRUPTED, _WRONG_MODE, _OUT_OF_RANGE, _NO_SIGNAL, _NO_UNIT = 1, 2, 3, 4, 5

Method = Callable[..., list[object] | str]


class IdsError(Exception):
    """A result with an error number."""

    def __init__(self, number: int, *values: object) -> None:
        super().__init__(number)
        self.number = number
        self.values = values


class IdsOptions(LengthOptions):
    """How this instrument is.

    Attributes:
        dialect: `ids` for com.attocube.ids, `sen` for the newer generation's com.attocube.sen.
        axis: the one that looks at the bench; the others see nothing.
        bare_mode: getCurrentMode answers a bare text instead of an array, as in older documents.
        start_time_s: bench time that the start of a measurement takes.
        ecu_enabled: the environment unit corrects from the start.
        absolute_u_mm: standard deviation of the length that a start finds, constant until the next one; no source.
    """

    dialect: Literal["ids", "sen"] = "ids"
    axis: int = Field(default=0, ge=0, le=2)
    bare_mode: bool = False
    start_time_s: float = 3.0
    ecu_enabled: bool = False
    absolute_u_mm: float = Field(default=0.02, ge=0.0, le=10.0)


class Ids:
    """The instrument that all clients share.

    Args:
        probe: what its environment unit measures.
        seed: of the errors of its absolute lengths.
    """

    def __init__(self, instrument: Instrument, probe: AirProbe, options: IdsOptions, seed: int = 0) -> None:
        self._instrument = instrument
        self._probe = probe
        self._options = options
        self._state = IDLE
        self._ready_s = 0.0
        self._breaks_cleared = 0
        self._reference_mm: float | None = None
        self._starts = np.random.default_rng([seed, 44])
        self._settings: dict[str, int | bool] = {
            "average": 0,
            "init": 0,
            "restart": True,
            "errors": 1,
            "output": 0,
        }
        self._pass_modes = dict.fromkeys(AXES, 0)
        self._master_axis = options.axis
        self._compensation = dict.fromkeys(AXES, 0)
        self._ecu_enabled = options.ecu_enabled
        self.methods: dict[str, Method] = self._named()

    @property
    def mode(self) -> str:
        """The mode's text at this moment."""
        starting = self._instrument.bench.time_s < self._ready_s
        return _STARTING.get(self._state, self._state) if starting else self._state

    def _named(self) -> dict[str, Method]:
        space = f"com.attocube.{self._options.dialect}."
        newer = self._options.dialect == "sen"
        methods = self._common() | (self._newer() if newer else self._older())
        unit = self._ecu() | (self._newer_ecu() if newer else self._older_ecu())
        return (
            {space + name: method for name, method in methods.items()}
            | {f"com.attocube.ecu.{name}": method for name, method in unit.items()}
            | {
                "com.attocube.system.errorNumberToString": self._error_text,
                "com.attocube.system.getFirmwareVersion": lambda: [0, "catseye 1.0"],
                "com.attocube.system.getDeviceName": lambda: [0, "catseye EMULATOR"],
            }
        )

    def _common(self) -> dict[str, Method]:
        return {
            "system.startMeasurement": lambda: self._start(RUNNING),
            "system.stopMeasurement": lambda: self._stop(RUNNING),
            "system.startOpticsAlignment": lambda: self._start(ALIGNING),
            "system.stopOpticsAlignment": lambda: self._stop(ALIGNING),
            "system.getCurrentMode": lambda: self.mode if self._options.bare_mode else [0, self.mode],
            "system.getSystemError": lambda: [self._fault(self._read())],
            "system.resetError": self._reset_error,
            "system.resetAxis": self._reset_axis,
            "system.resetAxes": lambda: self._reset_axis(self._options.axis),
            "system.setInitMode": lambda mode: self._set("init", mode, 0, 1),
            "system.getInitMode": lambda: [0, self._settings["init"]],
            "system.getDeviceType": lambda: [0, "IDS3010 EMULATOR"],
            "system.getFpgaVersion": lambda: [0, "1.0.0"],
            "system.getNbrFeaturesActivated": lambda: [0, 0],
            "displacement.getAxisDisplacement": self._displacement,
            "displacement.getAxesDisplacement": lambda: self._all(self._displacement),
            "displacement.getAbsolutePosition": self._absolute,
            "displacement.getAbsolutePositions": lambda: self._all(self._absolute),
            "displacement.getReferencePosition": self._reference,
            "displacement.getReferencePositions": lambda: self._all(self._reference),
            "displacement.getMeasurementEnabled": lambda: [0, self.mode == RUNNING],
            "displacement.setAverageN": lambda n: self._set("average", n, 0, 24),
            "displacement.getAverageN": lambda: [0, self._settings["average"]],
            "adjustment.getContrastInPermille": self._contrast,
            "adjustment.getAdjustmentEnabled": lambda: [0, self.mode == ALIGNING],
            "axis.getPassMode": lambda axis=0: [0, self._pass_modes[_axis(axis)]],
            "axis.getMasterAxis": lambda: [0, self._master_axis],
            "axis.setMasterAxis": self._set_master_axis,
            "axis.setPassMode": self._set_pass_mode,
            "realtime.getRtOutMode": lambda: [0, self._settings["output"]],
            "realtime.setRtOutMode": lambda mode: self._set("output", mode, 0, 8),
            "pilotlaser.enable": lambda: self._start(PILOT),
            "pilotlaser.disable": lambda: self._stop(PILOT),
        }

    def _older(self) -> dict[str, Method]:
        return {
            "system.applyInitMode": lambda: [0],
            "displacement.getSignalQuality": self._quality,
            "pilotlaser.isEnabled": lambda: [0, self.mode == PILOT],
        }

    def _newer(self) -> dict[str, Method]:
        return {
            "system.restartMeasurement": self._restart,
            "system.getAutoRestart": lambda: [0, self._settings["restart"]],
            "system.setAutoRestart": lambda on: self._set("restart", on, 0, 1),
            "system.getErrorParameterSet": lambda: [0, self._settings["errors"]],
            "system.setErrorParameterSet": lambda number: self._set("errors", number, 0, 2),
            "displacement.getAxisSignalQuality": self._quality,
            "pilotlaser.getEnabled": lambda: [0, self.mode == PILOT],
        }

    def _ecu(self) -> dict[str, Method]:
        return {
            "enable": lambda: self._enable_ecu(on=True),
            "disable": lambda: self._enable_ecu(on=False),
            "getTemperatureInDegrees": lambda: [0, self._air().temperature_c],
            "getPressureInHPa": lambda: [0, self._air().pressure_hpa],
            "getHumidityInPercent": lambda: [0, self._air().humidity_percent],
            "getRefractiveIndex": self._index,
        }

    def _older_ecu(self) -> dict[str, Method]:
        return {"isEnabled": lambda: [0, self._ecu_enabled], "isConnected": lambda: [0, True]}

    def _newer_ecu(self) -> dict[str, Method]:
        return {
            "getEnabled": lambda: [0, self._ecu_enabled],
            "getConnected": lambda: [0, True],
            "getRefractiveIndexCompensationMode": lambda axis: [0, self._compensation[_axis(axis)]],
            "setRefractiveIndexCompensationMode": self._set_compensation,
            "getRefractiveIndexForCompensation": self._index_of,
        }

    def _error_text(self, language: int, number: int) -> list[object]:
        del language
        return [0, f"EMULATOR: {_TEXTS.get(number, 'unknown error')}"]

    def _start(self, state: str) -> list[object]:
        if self._state != IDLE:
            raise IdsError(_WRONG_MODE)
        bench = self._instrument.bench
        self._state = state
        self._ready_s = bench.time_s + (0.0 if state == PILOT else self._options.start_time_s)
        if state == RUNNING:
            self._reset_count()
        return [0]

    def _stop(self, state: str) -> list[object]:
        if self._state != state:
            raise IdsError(_WRONG_MODE)
        self._state = IDLE
        return [0]

    def _restart(self) -> list[object]:
        self._stop(RUNNING)
        return self._start(RUNNING)

    def _reset_count(self) -> None:
        """Zero the count and find the absolute length, with an error of its own; without a beam there is none."""
        self._breaks_cleared = self._instrument.break_count
        self._reference_mm = None
        if self._instrument.zero():
            error_mm = float(self._starts.normal(0.0, self._options.absolute_u_mm))
            self._reference_mm = self._instrument.bench.beam.length_mm + error_mm

    def _reset_error(self, renormalize: bool = False) -> list[object]:
        del renormalize
        self._read()
        self._breaks_cleared = self._instrument.break_count
        return [0]

    def _reset_axis(self, axis: int) -> list[object]:
        self._require_running()
        if _axis(axis) != self._options.axis or not self._read().counts:
            raise IdsError(_NO_SIGNAL)
        self._reset_count()
        return [0]

    def _read(self) -> Reading:
        return self._instrument.read()

    def _fault(self, reading: Reading) -> int:
        lost = not reading.counts or self._instrument.break_count > self._breaks_cleared
        return _INTERRUPTED if lost else 0

    def _require_running(self) -> None:
        if self.mode != RUNNING:
            raise IdsError(_WRONG_MODE, 0)

    def _displacement(self, axis: int) -> list[object]:
        return list(self._way_pm(axis))

    def _way_pm(self, axis: int) -> tuple[int, int]:
        """Return the error and the displacement of an axis, pm."""
        self._require_running()
        if _axis(axis) != self._options.axis:
            return _NO_SIGNAL, 0
        reading = self._read()
        shown_mm = Lengths(self._ecu_enabled, self._options.sign).shown_mm(reading)
        return self._fault(reading), round(shown_mm * PM_PER_MM)

    def _reference(self, axis: int) -> list[object]:
        return list(self._start_pm(axis))

    def _start_pm(self, axis: int) -> tuple[int, int]:
        """Return the error and the length at the last reset of an axis, pm."""
        self._require_running()
        if _axis(axis) != self._options.axis or self._reference_mm is None:
            return _NO_SIGNAL, 0
        return 0, round(self._reference_mm * PM_PER_MM)

    def _absolute(self, axis: int) -> list[object]:
        error, way_pm = self._way_pm(axis)
        missing, start_pm = self._start_pm(axis)
        return [missing, 0] if missing else [error, start_pm + self._options.sign * way_pm]

    def _all(self, one: Callable[[int], list[object]]) -> list[object]:
        """Return the values of all axes; the error is that of the axis on the bench."""
        values = [one(axis) for axis in AXES]
        return [values[self._options.axis][0], *(value for _, value in values)]

    def _permille(self, axis: int) -> tuple[int, int]:
        """Return the error and the contrast of an axis."""
        if self.mode not in {RUNNING, ALIGNING}:
            raise IdsError(_WRONG_MODE, 0, 0, 0)
        if _axis(axis) != self._options.axis:
            return _NO_SIGNAL, 0
        reading = self._read()
        return (0 if reading.counts else _NO_SIGNAL), round(1000.0 * reading.level)

    def _contrast(self, axis: int) -> list[object]:
        error, contrast = self._permille(axis)
        return [error, contrast, 0, 0]

    def _quality(self, axis: int) -> list[object]:
        error, contrast = self._permille(axis)
        return [error, contrast, 0]

    def _air(self) -> AirSample:
        sample = self._probe.sample()
        if sample is None:
            raise IdsError(_NO_UNIT, 0.0)
        return sample

    def _index(self) -> list[object]:
        air = self._air()
        index = refractive_index(
            HE_NE_VACUUM_NM, air.temperature_c, air.pressure_hpa, air.humidity_percent, formula="edlen"
        )
        return [0, round(float(index), _INDEX_DECIMALS)]

    def _index_of(self, axis: int) -> list[object]:
        _axis(axis)
        return self._index()

    def _enable_ecu(self, *, on: bool) -> list[object]:
        self._ecu_enabled = on
        return [0]

    def _set(self, key: str, value: int, lowest: int, highest: int) -> list[object]:
        if not lowest <= value <= highest:
            raise IdsError(_OUT_OF_RANGE)
        self._settings[key] = value
        return [0]

    def _set_master_axis(self, axis: int) -> list[object]:
        self._master_axis = _axis(axis)
        return [0]

    def _set_pass_mode(self, *params: int) -> list[object]:
        *axes, mode = params
        if not 0 <= mode <= 4:
            raise IdsError(_OUT_OF_RANGE)
        self._pass_modes.update(dict.fromkeys(map(_axis, axes) if axes else AXES, mode))
        return [0]

    def _set_compensation(self, axis: int, mode: int) -> list[object]:
        self._compensation[_axis(axis)] = mode
        return [0]


def _axis(axis: int) -> int:
    if axis not in AXES:
        raise IdsError(_OUT_OF_RANGE, 0)
    return axis
