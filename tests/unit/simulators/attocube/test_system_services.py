"""The IDS's services about itself: names, passwords, updates, and air that somebody states by hand."""

import json
from typing import Any

import pytest

from catseye.calibration.air import HE_NE_VACUUM_NM, refractive_index
from catseye.simulators.context import EmulationContext
from catseye.simulators.emulator import NewSession
from tests.transcripts import attocube_services as transcript
from tests.unit.drivers.interferometers.pairs import maker, quiet_world
from tests.unit.simulators.attocube.clients import ask
from tests.unit.simulators.benches import aimed, go

DIALECTS = ("ids", "sen")
SYSTEM = "com.attocube.system."
ECU = "com.attocube.ecu."
MANUAL = ECU + "manual."


@pytest.fixture
def world() -> EmulationContext:
    return quiet_world()


def instrument(world: EmulationContext, dialect: str = "sen", **options: Any) -> NewSession:
    return maker(world, "attocube-ids", {"dialect": dialect, **options})


@pytest.mark.parametrize("dialect", DIALECTS)
@pytest.mark.parametrize("name", transcript.SERVICE_GETTERS)
def test_questions_about_the_system_are_answered(world: EmulationContext, dialect: str, name: str) -> None:
    params, count = transcript.SERVICE_GETTERS[name]
    number, *values = ask(instrument(world, dialect)(), name, *params)
    assert (number, len(values)) == (0, count)


@pytest.mark.parametrize("dialect", DIALECTS)
def test_actions_on_the_system_are_carried_out(world: EmulationContext, dialect: str) -> None:
    session = instrument(world, dialect)()
    for name, params in (transcript.SERVICE_ACTIONS | transcript.SERVICE_ACTIONS_OF[dialect]).items():
        assert ask(session, name, *params) == [0], name


def test_a_device_keeps_the_name_that_it_is_given(world: EmulationContext) -> None:
    session = instrument(world)()
    ask(session, SYSTEM + "setDeviceName", "bench 3")
    assert ask(session, SYSTEM + "getDeviceName") == [0, "bench 3"]


def test_recommendations_are_the_number_that_the_maker_states(world: EmulationContext) -> None:
    assert ask(instrument(world)(), SYSTEM + "errorNumberToRecommendation", 0, 1) == [0, 0]


def test_licences_are_those_of_packages_that_are_there(world: EmulationContext) -> None:
    session = instrument(world)()
    (name,) = ask(session, SYSTEM + "about.getInstalledPackages")[1].split(",")
    assert "EMULATOR" in ask(session, SYSTEM + "about.getPackageLicense", name)[1]
    assert ask(session, SYSTEM + "about.getPackageLicense", "other")[0] != 0


@pytest.mark.parametrize("kind", ["software", "license"])
def test_no_upload_is_ever_installed(world: EmulationContext, kind: str) -> None:
    session = instrument(world)()
    assert ask(session, f"{SYSTEM}update.{kind}UpdateBase64")[0] != 0
    upload = {"software": "uploadSoftwareImageBase64", "license": "uploadLicenseBase64"}[kind]
    assert ask(session, f"{SYSTEM}update.{upload}", 0, "not base64!")[0] != 0
    assert ask(session, f"{SYSTEM}update.{upload}", 5, "AAEC")[0] != 0
    assert ask(session, f"{SYSTEM}update.{upload}", 0, "AAEC") == [0]
    assert ask(session, f"{SYSTEM}update.{kind}UpdateBase64")[0] != 0


def test_a_time_that_does_not_exist_is_refused(world: EmulationContext) -> None:
    session = instrument(world)()
    assert ask(session, SYSTEM + "setTime", 31, 2, 2026, 0, 0, 0)[0] != 0
    assert ask(session, SYSTEM + "updateTimeFromInternet")[0] != 0


def test_newer_calls_about_the_system_are_unknown_to_the_older(world: EmulationContext) -> None:
    session = instrument(world, "ids")()
    for name in ("softReset", "setTime", "getHardwareInfo"):
        assert ask(session, SYSTEM + name)["code"] == -32601


def test_a_locked_device_obeys_who_knows_the_password(world: EmulationContext) -> None:
    new = instrument(world)
    owner, other = new(), new()
    assert ask(other, "getLockStatus") == [0, False, True]
    assert ask(owner, "lock", "secret") == [0]
    assert (ask(owner, "getLockStatus"), ask(other, "getLockStatus")) == ([0, True, True], [0, True, False])
    assert ask(owner, SYSTEM + "getDeviceName")[0] == 0
    refused = ask(other, SYSTEM + "getDeviceName")[0]
    assert refused != 0
    assert "locked" in ask(other, SYSTEM + "errorNumberToString", 0, refused)[1]
    assert ask(other, "com.attocube.sen.displacement.getAxesDisplacement") == [refused, 0, 0, 0]
    assert ask(other, "grantAccess", "wrong")[0] != 0
    assert ask(other, "grantAccess", "secret") == [0]
    assert ask(other, SYSTEM + "getDeviceName")[0] == 0


def test_a_lock_is_opened_with_its_password_only(world: EmulationContext) -> None:
    new = instrument(world)
    owner, other = new(), new()
    ask(owner, "lock", "secret")
    assert ask(other, "lock", "mine")[0] != 0
    assert ask(owner, "unlock", "wrong")[0] != 0
    assert ask(owner, "unlock", "secret") == [0]
    assert ask(other, "getLockStatus") == [0, False, True]
    assert ask(other, SYSTEM + "getDeviceName")[0] == 0


@pytest.mark.parametrize("name", transcript.MANUAL)
def test_air_is_stated_by_hand_within_its_range(world: EmulationContext, name: str) -> None:
    session = instrument(world)()
    low, value, high = transcript.MANUAL[name]
    for stated in (low, high, value):
        assert ask(session, f"{MANUAL}set{name}", -1, stated) == [0]
        assert ask(session, f"{MANUAL}get{name}", -1) == [0, stated]
    for wrong in (low - 0.1, high + 0.1):
        assert ask(session, f"{MANUAL}set{name}", -1, wrong)[0] != 0
    assert ask(session, f"{MANUAL}get{name}", -1) == [0, value]


@pytest.mark.parametrize("index", [1.0, 0.9])
def test_an_index_has_to_be_above_one(world: EmulationContext, index: float) -> None:
    assert ask(instrument(world)(), MANUAL + "setRefractiveIndex", -1, index)[0] != 0


def test_single_axes_are_of_a_later_firmware(world: EmulationContext) -> None:
    assert ask(instrument(world)(), MANUAL + "getRefractiveIndex", 0)[0] != 0
    later = instrument(world, compensates_axes=True)()
    assert ask(later, MANUAL + "setRefractiveIndex", 1, 1.00026) == [0]
    assert ask(later, MANUAL + "getRefractiveIndex", 1) == [0, 1.00026]
    assert ask(later, MANUAL + "getRefractiveIndex", 0) != [0, 1.00026]


def test_the_mode_chooses_the_index_of_compensation(world: EmulationContext) -> None:
    session = instrument(world)()
    for name, (_, value, _) in transcript.MANUAL.items():
        ask(session, f"{MANUAL}set{name}", -1, value)
    ask(session, MANUAL + "setRefractiveIndex", -1, 1.000123)
    found = []
    for mode in (0, 1, 2):
        assert ask(session, ECU + "setRefractiveIndexCompensationMode", -1, mode) == [0]
        found.append(ask(session, ECU + "getRefractiveIndexForCompensation", -1)[1])
    ciddor = float(refractive_index(HE_NE_VACUUM_NM, 23.4, 987.6, 45.5, formula="ciddor"))
    assert found[0] == ask(session, ECU + "getRefractiveIndex")[1]
    assert found[1:] == [pytest.approx(ciddor, abs=1e-9), 1.000123]


def test_lengths_follow_the_index_that_is_stated(world: EmulationContext) -> None:
    session = instrument(world, ecu_enabled=True, start_time_s=0.0)()
    ask(session, ECU + "setRefractiveIndexCompensationMode", -1, 2)
    ask(session, MANUAL + "setRefractiveIndex", -1, 1.0005)
    ask(session, "com.attocube.sen.system.startMeasurement")
    first_mm = world.beam_bench.true_state().length_mm
    go(world.beam_bench, aimed(22.0, 33.0))
    way_mm = world.beam_bench.true_state().length_mm - first_mm
    shown_mm = 1e-9 * ask(session, "com.attocube.sen.displacement.getAxisDisplacement", 0)[1]
    assert shown_mm / way_mm == pytest.approx(world.bench.air_index() / 1.0005, abs=2e-6)


def test_a_reboot_ends_connections_and_the_measurement(world: EmulationContext) -> None:
    new = instrument(world, "ids", start_time_s=0.0, boot_time_s=20.0)
    session, other = new(), new()
    ask(session, "com.attocube.ids.system.startMeasurement")
    ask(session, "com.attocube.ids.axis.setPassMode", 1)
    assert ask(session, SYSTEM + "rebootSystem") == [0]
    assert session.over
    assert other.over
    assert new().over
    world.bench.advance(20.1)
    again = new()
    assert not again.over
    assert ask(again, "com.attocube.ids.system.getCurrentMode") == [0, "system idle"]
    ask(again, "com.attocube.ids.axis.apply")
    assert ask(again, "com.attocube.ids.axis.getPassMode") == [0, 0]


def test_a_newer_instrument_measures_again_after_a_reboot(world: EmulationContext) -> None:
    new = instrument(world, "sen", start_time_s=3.0, boot_time_s=20.0)
    for restarts, mode in ((True, "measurement running"), (False, "system idle")):
        session = new()
        ask(session, "com.attocube.sen.system.startMeasurement")
        ask(session, "com.attocube.sen.system.setAutoRestart", restarts)
        ask(session, SYSTEM + "rebootSystem")
        world.bench.advance(30.0)
        assert ask(new(), "com.attocube.sen.system.getCurrentMode") == [0, mode]


def test_a_factory_reset_acts_at_the_next_reboot(world: EmulationContext) -> None:
    new = instrument(world, "ids", boot_time_s=1.0)
    session = new()
    ask(session, "com.attocube.ids.displacement.setAverageN", 7)
    ask(session, SYSTEM + "setDeviceName", "bench 3")
    ask(session, SYSTEM + "factoryReset")
    assert ask(session, "com.attocube.ids.displacement.getAverageN") == [0, 7]
    ask(session, SYSTEM + "rebootSystem")
    world.bench.advance(2.0)
    again = new()
    assert ask(again, "com.attocube.ids.displacement.getAverageN") == [0, 0]
    assert "EMULATOR" in ask(again, SYSTEM + "getDeviceName")[1]


@pytest.mark.parametrize("params", [(3,), (None,), ()])
def test_a_password_is_a_text(world: EmulationContext, params: tuple[object, ...]) -> None:
    assert ask(instrument(world)(), "lock", *params)["code"] == -32602


def test_a_request_for_a_service_is_one_line_of_json(world: EmulationContext) -> None:
    session = instrument(world)()
    session.feed(json.dumps({"jsonrpc": "2.0", "method": "getLockStatus", "id": 5, "api": 2}).encode())
    answer = session.answer()
    assert isinstance(answer, bytes)
    assert answer.endswith(b"\r\n")
