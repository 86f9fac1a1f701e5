"""Public Python clients, unmodified, in an environment of their own (`make peers` makes it)."""

import json
from dataclasses import replace

import pytest

from catseye.simulators.config import EmulatedDevice, Option, TruthText
from catseye.simulators.emulated_bench import EmulatedBench
from tests.peers.environment import output_of
from tests.system.test_ways_of_following import TRUTH
from tests.unit.simulators.benches import QUIET
from tests.unit.simulators.trackers import near, tracker_bench


async def test_set_points_of_melfapy_lead_the_arm() -> None:
    # It never ends the stream, and a busy machine may hold it up: the controller waits without limit.
    options: dict[str, Option] = {"mxt_mode": "xyz", "mxt_timeout_s": -1.0}
    devices = (EmulatedDevice("robot", "melfa-mxt", "udp://127.0.0.1:0", options),)
    config = replace(QUIET, devices=devices, start_joints=(20.0, 40.0, 0.0, 10.0))
    async with EmulatedBench(config) as bench:
        bench.controller.switch_servo_on()
        bench.bench.advance(2.0)
        port = bench.endpoints[0].endpoint.rpartition(":")[2]
        before, after = await output_of("set_points.py", "127.0.0.1", port, "-30", "30")
        bench.keeper.sync()
        assert bench.controller.alarm == 0
    assert after[:3] == pytest.approx([before[0] - 30.0, before[1] + 30.0, before[2]], abs=0.01)
    assert after[5] == pytest.approx(before[5], abs=1e-4)


async def test_the_makers_api_reads_displacements() -> None:
    truth = TruthText(json.dumps(TRUTH).encode(), "truth.json")
    # The API knows one port.
    device = EmulatedDevice("interferometer", "attocube-ids", "tcp://127.0.0.1:9090", {"dialect": "sen"})
    async with EmulatedBench(replace(QUIET, devices=(device,), truth=truth)):
        said = await output_of("displacements.py", "127.0.0.1")
    assert said["mode"] == "measurement running"
    assert said["enabled"] is True
    warning, displacement_pm = said["displacement_pm"]
    assert warning == 0
    # The arm rests and the measurement has just begun.
    assert abs(displacement_pm) < 1_000_000


async def test_the_makers_api_finds_its_other_services() -> None:
    truth = TruthText(json.dumps(TRUTH).encode(), "truth.json")
    options: dict[str, Option] = {"dialect": "sen", "start_time_s": 0.5, "nlc_time_s": 0.5}
    device = EmulatedDevice("interferometer", "attocube-ids", "tcp://127.0.0.1:0", options)
    async with EmulatedBench(replace(QUIET, devices=(device,), truth=truth)) as bench:
        port = bench.endpoints[0].endpoint.rpartition(":")[2]
        said = await output_of("interferometer_services.py", "127.0.0.1", port)
    assert [len(values) for values in said["idle"].values()] == [4, 4, 4, 3, 4]
    assert all(number != 0 for number, *_ in said["idle"].values())
    assert said["settings"] == {
        "pass_mode": 1,
        "master": 2,
        "axes": [True, True, True],
        "output": 1,
        "distance": 2,
        "clock_ns": 80,
        "window": 4,
        "refused": "Error! EMULATOR: parameter out of range",
        "address": "192.0.2.9",
        "radio": False,
        "passphrase": "Error! EMULATOR: not fitted",
    }
    assert said["itself"] == {
        "temperature": 21.5,
        "index": 1.00026,
        "pressure": "Error! EMULATOR: parameter out of range",
        "name": "bench 3",
        "recommendation": 0,
        "locked": [True, True],
        "unlocked": [False, True],
        "license": "EMULATOR: see the licence of catseye",
        "progress": 0,
        "update": "Error! EMULATOR: nothing was uploaded that can be installed here",
    }
    assert said["no table"] == "Error! EMULATOR: not possible in this mode"
    assert all(number == 0 for number, *_ in said["running"].values())
    assert said["tables"] == {"status": [0, True], "applied": True, "points": 512, "curve": 512}


async def test_the_public_emscon_client_measures_points() -> None:
    async with tracker_bench("leica-emscon", speed=10.0) as bench:
        port = bench.endpoints[0].endpoint.rpartition(":")[2]
        place_m = [1e-3 * value for value in near(bench, "nest1")]
        said = await output_of("tracker_point.py", "127.0.0.1", port, *map(str, place_m))
    assert said["place_m"] == pytest.approx(place_m, abs=2e-6)
    assert said["again_m"] == pytest.approx(place_m, abs=2e-6)
    assert (said["face"], said["other_face"], said["faces"]) == (1, 2, 2)
    assert said["processor"] == 5
    assert said["units"] == [0, 0]
    assert said["temperature_c"] == pytest.approx(20.0, abs=1.0)
    assert said["index"] == pytest.approx(1.00027, abs=1e-5)
    assert max(map(abs, said["home_m"])) < 0.2
    assert said["refused"] == "Command 55 failed with status 37"
    assert said["reflectors"] == 3
    assert said["name"] == "AT901-MR EMULATOR"
