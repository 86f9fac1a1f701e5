"""An air sensor is off by what its calibration leaves, and no two sensors are off alike."""

import json
import re
import struct
from collections.abc import Callable

import numpy as np
import pytest

from catseye.simulators.context import EmulationContext
from catseye.simulators.world.types import Floats
from tests.unit.simulators.trackers import Client as TrackerClient
from tests.unit.simulators.trackers import tracker_bench
from tests.unit.simulators.truth.worlds import BUDGET, assert_unsure, heard, said, session_of, world

U = np.array([BUDGET.air_temperature_k, BUDGET.air_pressure_hpa, BUDGET.air_humidity_percent])
SEEDS = range(14)
PROTOCOLS = ("modbus-air", "vaisala-ascii", "attocube-ids", "lasertex-hpi", "umd", "leica-emscon")


def vaisala_registers(context: EmulationContext) -> Floats:
    session = session_of(context, "modbus-air", "environment")

    def value(address: int) -> float:
        reply = said(context, session, struct.pack(">HHHBBHH", 1, 0, 6, 1, 3, address, 2))
        low, high = struct.unpack(">2H", reply[-4:])
        return float(struct.unpack(">f", struct.pack(">2H", high, low))[0])

    return np.array([value(0x0002), value(0x002C), value(0x0000)])


def vaisala_text(context: EmulationContext) -> Floats:
    line = said(context, session_of(context, "vaisala-ascii", "ptu"), b"SEND\r").decode()
    found = {name: float(re.search(rf"{name}=\s*([-\d.]+)", line)[1]) for name in ("P", " T", "RH")}  # type: ignore[index]  # they are there
    return np.array([found[" T"], found["P"], found["RH"]])


def unit_of_an_ids(context: EmulationContext) -> Floats:
    session = session_of(context, "attocube-ids", "ids")
    names = ("getTemperatureInDegrees", "getPressureInHPa", "getHumidityInPercent")
    requests = [json.dumps({"method": f"com.attocube.ecu.{name}", "id": 1}).encode() for name in names]
    return np.array([json.loads(said(context, session, one))["result"][1] for one in requests])


def meteo_of_an_hpi(context: EmulationContext) -> Floats:
    session = session_of(context, "lasertex-hpi", "hpi")
    said(context, session, bytes.fromhex("AAB0790000000035"))
    frame = heard(context, session, 1.1)[:16]
    temperature, humidity = struct.unpack_from(">hB", frame, 4)
    (pressure,) = struct.unpack_from(">H", frame, 9)
    return np.array([0.01 * temperature, 0.1 * pressure, float(humidity)])


def low_codes_of_a_umd(context: EmulationContext) -> Floats:
    lines = heard(context, session_of(context, "umd", "umd"), 0.2).decode().split("\r\n")
    codes = {int(line.split()[6]): float(line.split()[7]) for line in lines[:-1]}
    return np.array([0.01 * codes[3], 0.01 * codes[5], codes[6]])


READ: dict[str, tuple[Callable[[EmulationContext], Floats], Floats]] = {
    "modbus-air": (vaisala_registers, np.zeros(3)),
    "vaisala-ascii": (vaisala_text, np.array([0.1, 0.1, 0.1])),
    "attocube-ids": (unit_of_an_ids, np.zeros(3)),
    "lasertex-hpi": (meteo_of_an_hpi, np.array([0.01, 0.1, 1.0])),
    "umd": (low_codes_of_a_umd, np.array([0.01, 0.01, 1.0])),
}
"""Reads °C, hPa, %; and the steps of what is said."""


def errors_of(context: EmulationContext, protocol: str) -> Floats:
    read, _ = READ[protocol]
    shown, air = read(context), context.bench.air()
    return np.asarray(shown - np.array([air.temperature_c, air.pressure_hpa, air.humidity_percent]))


@pytest.mark.parametrize("protocol", READ)
def test_the_air_is_known_as_well_as_a_calibration(protocol: str) -> None:
    errors = np.array([errors_of(world(seed), protocol) for seed in SEEDS])
    steps = READ[protocol][1]
    for quantity in range(3):
        u = float(np.hypot(U[quantity], steps[quantity] / np.sqrt(12.0)))
        assert_unsure(errors[:, quantity].tolist(), float(U[quantity]), 1.05 * u)


def test_changes_of_the_air_are_read_with_noise() -> None:
    context = world()
    errors = []
    for _ in range(20):
        context.bench.advance(10.0)
        errors.append(errors_of(context, "modbus-air"))
    spread = np.array(errors).std(axis=0, ddof=1)
    assert np.all((spread > 0.04 * U) & (spread < 0.2 * U))


def test_two_sensors_of_a_bench_disagree() -> None:
    context = world()
    found = np.array([errors_of(context, protocol) for protocol in ("modbus-air", "attocube-ids")])
    assert np.all(np.abs(found[0] - found[1]) > 0.05 * U)


def test_a_weather_station_of_a_tracker_is_off() -> None:
    bench = tracker_bench("leica-emscon", options={"initialised": True})
    client = TrackerClient(bench)
    # The weather monitor calculates, and no news are sent.
    client.say(struct.pack("<12i", 48, 0, 47, 2, 0, 0, 1, 0, 0, 0, 1, 0))
    shown = np.array(struct.unpack_from("<3d", client.say(struct.pack("<3i", 12, 0, 21)), 16))
    air = bench.bench.air()
    true = np.array([air.temperature_c, air.pressure_hpa, air.humidity_percent])
    assert np.all(np.abs(shown - true) > 0.02 * U)
    assert np.all(np.abs(shown - true) < 5.0 * U)
