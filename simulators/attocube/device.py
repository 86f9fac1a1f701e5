"""The IDS behind its methods: modes, one axis on the bench's beam, environment unit, pilot laser.

Names, modes and the layout of results come from the sheet and from the maker's API. Not known, and assumed here: the
numbers and texts of errors (all say EMULATOR); how long a start takes; that an interrupted axis shows its error until
`resetError`, a reset of the axis or a restart; that an instrument that does not measure answers zeros behind its
error number, and knows of no lost beam. Averaging is remembered and has no effect. Every start finds the absolute
length anew; half of the variance of its error is the instrument's own and remains, half is another at each start.
Without the environment unit it is one in vacuum wavelengths, like the displacement. A reboot ends all connections
and drops what was not applied.
"""

import math
from collections.abc import Callable
from functools import partial
from typing import Literal

import numpy as np
from pydantic import Field

from catseye.simulators.attocube.access import Access
from catseye.simulators.attocube.axes import AxisService
from catseye.simulators.attocube.environment import Environment
from catseye.simulators.attocube.errors import (
    AXES,
    INTERRUPTED,
    NO_SIGNAL,
    OUT_OF_RANGE,
    WRONG_MODE,
    IdsError,
    checked,
    checked_axis,
)
from catseye.simulators.attocube.network import Network
from catseye.simulators.attocube.nonlinearity import Nonlinearity
from catseye.simulators.attocube.realtime import Realtime
from catseye.simulators.attocube.results import Later, Method
from catseye.simulators.attocube.system_service import SystemService
from catseye.simulators.lengths import LengthOptions
from catseye.simulators.world.air_probe import AirProbe
from catseye.simulators.world.counter import Reading
from catseye.simulators.world.instrument import Instrument

PM_PER_MM = 1e9

IDLE = "system idle"
RUNNING = "measurement running"
ALIGNING = "optics alignment running"
PILOT = "pilot laser enabled"
TESTING = "test channels enabled"
_STARTING = {RUNNING: "measurement starting", ALIGNING: "optics alignment starting"}


class IdsOptions(LengthOptions):
    """How this instrument is.

    Attributes:
        dialect: `ids` for com.attocube.ids, `sen` for the newer generation's com.attocube.sen.
        axis: the one that looks at the bench; the others see nothing.
        bare_mode: getCurrentMode answers a bare text instead of an array, as in older documents.
        start_time_s: bench time that the start of a measurement takes.
        ecu_enabled: the environment unit corrects from the start.
        absolute_u_mm: standard uncertainty of the length that a start finds, constant until the next one; no source.
        getters_show: what getters of axis, realtime and network answer between a setter and `apply`; no source.
        nlc_time_s: bench time that an estimation of nonlinearities takes; the maker's client waits 20 s.
        renormalize_time_s: bench time of `resetError(true)`; by the maker 14 s to 20 s.
        compensates_axes: the environment unit corrects axis by axis; by the maker not yet, only all (-1).
        boot_time_s: bench time of a reboot; no source.
        ip_address: what the network service states; the emulator listens at its endpoint.
        wifi: the instrument has a radio.
    """

    dialect: Literal["ids", "sen"] = "ids"
    axis: int = Field(default=0, ge=0, le=2)
    bare_mode: bool = False
    start_time_s: float = 3.0
    ecu_enabled: bool = False
    absolute_u_mm: float = Field(default=0.02, ge=0.0, le=10.0)
    getters_show: Literal["applied", "pending"] = "applied"
    nlc_time_s: float = Field(default=10.0, ge=0.0, le=600.0)
    renormalize_time_s: float = Field(default=17.0, ge=0.0, le=600.0)
    compensates_axes: bool = False
    boot_time_s: float = Field(default=30.0, ge=0.0, le=600.0)
    ip_address: str = "192.0.2.1"
    wifi: bool = False


class Ids:
    """The instrument that all clients share.

    Args:
        probe: what its environment unit measures.
        seed: of the errors of its absolute lengths.

    Attributes:
        access: its lock.
        boots: how often it was rebooted.
        methods: what it can do, by full name.
    """

    def __init__(self, instrument: Instrument, probe: AirProbe, options: IdsOptions, seed: int = 0) -> None:
        self._instrument = instrument
        self._probe = probe
        self._options = options
        self._state = IDLE
        self._ready_s = 0.0
        self._begun = 0
        self._breaks_cleared = 0
        self._reference_mm: float | None = None
        self._starts = np.random.default_rng([seed, 44])
        self._part_u_mm = math.sqrt(0.5) * options.absolute_u_mm
        self._own_error_mm = float(np.random.default_rng([seed, 46]).normal(0.0, self._part_u_mm))
        self.access = Access()
        self.boots = 0
        self._up_s = -math.inf
        self._network = self._new_network()
        self._set_defaults()

    def _set_defaults(self) -> None:
        """Forget what clients have set, but for the network."""
        options = self._options
        self._settings: dict[str, int | bool] = {
            "average": 0,
            "init": 0,
            "restart": True,
            "errors": 1,
            "optimize": False,
        }
        self._environment = Environment(
            self._probe,
            options.dialect,
            options.axis,
            enabled=options.ecu_enabled,
            by_axis=options.compensates_axes,
        )
        self._system = SystemService(options.dialect, self._reboot, self._set_defaults)
        self.methods: dict[str, Method] = self._named()

    @property
    def is_up(self) -> bool:
        """It has booted."""
        return self._instrument.bench.time_s >= self._up_s

    @property
    def mode(self) -> str:
        """The mode's text at this moment."""
        starting = self._instrument.bench.time_s < self._ready_s
        return _STARTING.get(self._state, self._state) if starting else self._state

    def _named(self) -> dict[str, Method]:
        space = f"com.attocube.{self._options.dialect}."
        newer = self._options.dialect == "sen"
        methods = self._services() | self._common() | (self._newer() if newer else self._older())
        return (
            {space + name: method for name, method in methods.items()}
            | self._environment.methods()
            | self._network.methods()
            | self._system.methods()
        )

    def _new_network(self) -> Network:
        options = self._options
        return Network(options.ip_address, radio=options.wifi, shows_pending=self._shows_pending)

    @property
    def _shows_pending(self) -> bool:
        return self._options.getters_show == "pending"

    def _services(self) -> dict[str, Method]:
        dialect, shows = self._options.dialect, self._shows_pending
        return (
            AxisService(dialect, self._options.axis, shows_pending=shows).methods()
            | Realtime(dialect, shows_pending=shows).methods()
            | Nonlinearity(dialect, self._estimate).methods()
        )

    def _common(self) -> dict[str, Method]:
        return {
            "system.startMeasurement": lambda: self._start(RUNNING),
            "system.stopMeasurement": lambda: self._stop(RUNNING),
            "system.startOpticsAlignment": lambda: self._start(ALIGNING),
            "system.stopOpticsAlignment": lambda: self._stop(ALIGNING),
            "system.getCurrentMode": lambda: self.mode if self._options.bare_mode else [0, self.mode],
            "system.getSystemError": self._system_error,
            "system.resetError": self._reset_error,
            "system.resetAxis": self._reset_axis,
            "system.resetAxes": lambda: self._reset_axis(self._options.axis),
            "system.setInitMode": lambda mode: self._set("init", mode, 0, 1),
            "system.getInitMode": lambda: [0, self._settings["init"]],
            "system.getDeviceType": lambda: [0, "IDS3010 EMULATOR"],
            "system.getFpgaVersion": lambda: [0, "1.0.0"],
            "system.getNbrFeaturesActivated": lambda: [0, 0],
            "system.getFeaturesName": self._feature,
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
            "displacement.getAxisSignalQuality": self._quality,
            "realtime.disableTestChannel": lambda: self._stop(TESTING),
            "realtime.getTestChannelEnabled": lambda: [0, self.mode == TESTING],
            "pilotlaser.enable": lambda: self._start(PILOT),
            "pilotlaser.disable": lambda: self._stop(PILOT),
            "pilotlaser.getEnabled": lambda: [0, self.mode == PILOT],
        }

    def _older(self) -> dict[str, Method]:
        return {
            "system.applyInitMode": lambda: [0],
            "displacement.getSignalQuality": self._quality,
            "pilotlaser.isEnabled": lambda: [0, self.mode == PILOT],
            "realtime.enableTestChannel": self._test_channel,
        }

    def _newer(self) -> dict[str, Method]:
        return {
            "system.restartMeasurement": self._restart,
            "system.getAutoRestart": lambda: [0, self._settings["restart"]],
            "system.setAutoRestart": lambda on: self._set("restart", on, 0, 1),
            "system.getErrorParameterSet": lambda: [0, self._settings["errors"]],
            "system.getOptimizeParametersDuringInit": lambda: [0, self._settings["optimize"]],
            "system.setOptimizeParametersDuringInit": lambda on: self._set("optimize", on, 0, 1),
            "system.setErrorParameterSet": lambda number: self._set("errors", number, 0, 2),
            "realtime.enableTestChannel": lambda: self._start(TESTING),
        }

    def _start(self, state: str) -> list[object]:
        if self._state != IDLE:
            raise IdsError(WRONG_MODE)
        bench = self._instrument.bench
        self._state = state
        self._begun += 1
        self._ready_s = bench.time_s + (self._options.start_time_s if state in _STARTING else 0.0)
        if state == RUNNING:
            self._reset_count()
        return [0]

    def _feature(self, number: int) -> list[object]:
        """Refuse: none is activated."""
        del number
        raise IdsError(OUT_OF_RANGE)

    def _test_channel(self, axis: int) -> list[object]:
        checked_axis(axis)
        return self._start(TESTING)

    def _stop(self, state: str) -> list[object]:
        if self._state != state:
            raise IdsError(WRONG_MODE)
        self._state = IDLE
        return [0]

    def _restart(self) -> list[object]:
        self._stop(RUNNING)
        return self._start(RUNNING)

    def _reboot(self) -> None:
        """Leave everything, drop what was not applied, and be away for a while; the count begins anew."""
        measured, self._state = self._state == RUNNING, IDLE
        self.boots += 1
        self._up_s = self._instrument.bench.time_s + self._options.boot_time_s
        for name, method in self.methods.items():
            if name.endswith(".discard"):
                method()
        if self._system.resets:
            self._network = self._new_network()
            self._set_defaults()
        self._instrument.restart()
        if measured and self._options.dialect == "sen" and self._settings["restart"]:
            self._instrument.bench.call_at(self._up_s, partial(self._measure_again, self.boots))

    def _measure_again(self, boots: int) -> None:
        if boots == self.boots and self._state == IDLE:
            self._start(RUNNING)

    def _reset_count(self) -> None:
        """Zero the count and find the absolute length, with an error of its own; without a beam there is none."""
        self._breaks_cleared = self._instrument.break_count
        self._reference_mm = None
        if self._instrument.zero():
            bench = self._instrument.bench
            error_mm = self._own_error_mm + float(self._starts.normal(0.0, self._part_u_mm))
            part = self._environment.shown_part(bench.air_index())
            self._reference_mm = part * bench.beam.length_mm + error_mm

    def _reset_error(self, renormalize: bool = False) -> list[object] | Later:
        if renormalize:
            self._require_running()
            return self._occupied(self._options.renormalize_time_s, self._clear_error)
        return self._clear_error()

    def _clear_error(self) -> list[object]:
        self._read()
        self._breaks_cleared = self._instrument.break_count
        return [0]

    def _occupied(self, duration_s: float, result: Callable[[], list[object]]) -> Later:
        """Leave the measurement for a time, as at its start; the count goes on."""
        bench = self._instrument.bench
        until_s = self._ready_s = bench.time_s + duration_s
        return Later(lambda: until_s if bench.time_s < until_s else None, result)

    def _estimate(self, axis: int, succeeded: Callable[[], list[object]]) -> Later:
        self._require_running()
        measurement = self._begun

        def result() -> list[object]:
            self._require_running()
            if self._begun != measurement:
                raise IdsError(WRONG_MODE)
            if axis != self._options.axis or self._fault(self._read()):
                raise IdsError(NO_SIGNAL)
            return succeeded()

        return self._occupied(self._options.nlc_time_s, result)

    def _reset_axis(self, axis: int) -> list[object]:
        self._require_running()
        if checked_axis(axis) != self._options.axis or not self._read().counts:
            raise IdsError(NO_SIGNAL)
        self._reset_count()
        return [0]

    def _read(self) -> Reading:
        return self._instrument.read()

    def _fault(self, reading: Reading) -> int:
        lost = not reading.counts or self._instrument.break_count > self._breaks_cleared
        return INTERRUPTED if lost else 0

    def _system_error(self) -> list[object]:
        return [self._fault(self._read()) if self._state in _STARTING else 0]

    def _require_running(self) -> None:
        if self.mode != RUNNING:
            raise IdsError(WRONG_MODE)

    def _displacement(self, axis: int) -> list[object]:
        return list(self._way_pm(axis))

    def _way_pm(self, axis: int) -> tuple[int, int]:
        """Return the error and the displacement of an axis, pm."""
        self._require_running()
        if checked_axis(axis) != self._options.axis:
            return NO_SIGNAL, 0
        reading = self._read()
        shown_mm = self._environment.shown_mm(reading, self._options.sign)
        return self._fault(reading), round(shown_mm * PM_PER_MM)

    def _reference(self, axis: int) -> list[object]:
        return list(self._start_pm(axis))

    def _start_pm(self, axis: int) -> tuple[int, int]:
        """Return the error and the length at the last reset of an axis, pm."""
        self._require_running()
        if checked_axis(axis) != self._options.axis or self._reference_mm is None:
            return NO_SIGNAL, 0
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
            raise IdsError(WRONG_MODE)
        if checked_axis(axis) != self._options.axis:
            return NO_SIGNAL, 0
        reading = self._read()
        return (0 if reading.counts else NO_SIGNAL), round(1000.0 * reading.level)

    def _contrast(self, axis: int) -> list[object]:
        error, contrast = self._permille(axis)
        return [error, contrast, 0, 0]

    def _quality(self, axis: int) -> list[object]:
        error, contrast = self._permille(axis)
        return [error, contrast, 0]

    def _set(self, key: str, value: int, lowest: int, highest: int) -> list[object]:
        self._settings[key] = checked(value, lowest, highest)
        return [0]
