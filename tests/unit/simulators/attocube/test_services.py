"""The IDS outside of measurement, asked as the maker's API asks it (`tests/transcripts/attocube_services.py`)."""

import json
from collections.abc import Iterator
from typing import Any

import pytest

from catseye.simulators.context import EmulationContext
from catseye.simulators.ports.session import Session
from tests.transcripts import attocube_ids
from tests.transcripts import attocube_services as transcript
from tests.unit.drivers.interferometers.pairs import new_session, quiet_world
from tests.unit.simulators.attocube.clients import ask, send, wait

DIALECTS = ("ids", "sen")
ZEROS = [0] * 512


@pytest.fixture
def world() -> EmulationContext:
    return quiet_world()


def idle(world: EmulationContext, dialect: str = "sen", **options: Any) -> tuple[Session, str]:
    session = new_session(world, "attocube-ids", {"dialect": dialect, **options})
    return session, f"com.attocube.{dialect}."


def running(world: EmulationContext, dialect: str = "sen", **options: Any) -> tuple[Session, str]:
    session, space = idle(world, dialect, start_time_s=0.0, **options)
    assert ask(session, space + "system.startMeasurement") == [0]
    return session, space


def getters(dialect: str) -> Iterator[tuple[str, tuple[object, ...], int]]:
    for name, (params, count) in (transcript.GETTERS | transcript.GETTERS_OF[dialect]).items():
        yield name, params, count


@pytest.mark.parametrize("dialect", DIALECTS)
@pytest.mark.parametrize("name", transcript.WARNINGS)
def test_an_idle_instrument_answers_all_values_that_clients_read(
    world: EmulationContext, dialect: str, name: str
) -> None:
    session, space = idle(world, dialect)
    params, count = transcript.WARNINGS[name]
    number, *values = ask(session, space + name, *params)
    assert values == [0] * count
    assert (number == 0) is (name == "nlc.getLutStatus")


@pytest.mark.parametrize("name", [name for name, (params, _) in transcript.WARNINGS.items() if params])
def test_an_axis_out_of_range_answers_all_values(world: EmulationContext, name: str) -> None:
    session, space = running(world)
    number, *values = ask(session, space + name, 3)
    assert number != 0
    assert values == [0] * transcript.WARNINGS[name][1]


@pytest.mark.parametrize("dialect", DIALECTS)
def test_idle_getters_answer_what_clients_read(world: EmulationContext, dialect: str) -> None:
    session, space = idle(world, dialect)
    for name, params, count in getters(dialect):
        number, *values = ask(session, space + name, *params)
        assert (name, number, len(values)) == (name, 0, count)


@pytest.mark.parametrize("dialect", DIALECTS)
@pytest.mark.parametrize("name", transcript.SETTERS)
def test_a_setting_acts_once_it_is_applied(world: EmulationContext, dialect: str, name: str) -> None:
    session, space = idle(world, dialect)
    value, getter = transcript.SETTERS[name]
    service = name.partition(".")[0]
    before = ask(session, space + getter)
    assert ask(session, space + name, value) == [0]
    assert ask(session, space + getter) == before
    assert ask(session, f"{space}{service}.apply") == [0]
    assert ask(session, space + getter) == [0, value]


@pytest.mark.parametrize("name", transcript.SETTERS)
def test_a_discarded_setting_never_acts(world: EmulationContext, name: str) -> None:
    session, space = idle(world)
    value, getter = transcript.SETTERS[name]
    service = name.partition(".")[0]
    before = ask(session, space + getter)
    assert ask(session, space + name, value) == [0]
    assert ask(session, f"{space}{service}.discard") == [0]
    assert ask(session, f"{space}{service}.apply") == [0]
    assert ask(session, space + getter) == before


def test_getters_may_show_what_waits_for_apply(world: EmulationContext) -> None:
    session, space = idle(world, getters_show="pending")
    assert ask(session, space + "realtime.setRtOutMode", 4) == [0]
    assert ask(session, space + "realtime.getRtOutMode") == [0, 4]
    assert ask(session, space + "realtime.discard") == [0]
    assert ask(session, space + "realtime.getRtOutMode") == [0, 0]


@pytest.mark.parametrize(
    ("dialect", "name", "value"),
    [
        ("ids", "axis.setPassMode", 4),
        ("sen", "axis.setPassMode", 2),
        ("sen", "axis.setMasterAxis", 3),
        ("sen", "realtime.setRtOutMode", 10),
        ("ids", "realtime.setResolutionHsslHigh", 47),
        ("sen", "realtime.setResolutionHsslHigh", 48),
        ("sen", "realtime.setResolutionBissC", 17),
        ("sen", "realtime.setRtDistanceMode", 3),
        ("sen", "realtime.setPeriodHsslClk", 39),
    ],
)
def test_settings_out_of_range_are_refused(
    world: EmulationContext, dialect: str, name: str, value: int
) -> None:
    session, space = idle(world, dialect)
    (number,) = ask(session, space + name, value)
    assert "out of range" in ask(session, "com.attocube.system.errorNumberToString", 1, number)[1]


def test_a_clock_is_rounded_to_40_ns(world: EmulationContext) -> None:
    session, space = idle(world)
    assert ask(session, space + "realtime.setPeriodHsslClk", 95) == [0]
    assert ask(session, space + "realtime.apply") == [0]
    assert ask(session, space + "realtime.getPeriodHsslClk") == [0, 80]


def test_settings_without_apply_act_at_once(world: EmulationContext) -> None:
    session, space = idle(world)
    assert ask(session, space + "realtime.setAaf", True, 12, 3) == [0]
    shown = [
        ask(session, f"{space}realtime.getAaf{name}")[1] for name in ("Enabled", "Attenuation", "Window")
    ]
    assert shown == [True, 12, 3]
    assert ask(session, space + "realtime.enableRtAxis", 1, False) == [0]
    assert ask(session, space + "realtime.getRtAxisEnabled", 1) == [0, False]
    assert ask(session, space + "axis.setAutoMasterAxis", False) == [0]
    assert ask(session, space + "axis.getAutoMasterAxis") == [0, False]


@pytest.mark.parametrize(("dialect", "params"), [("ids", (1,)), ("sen", ())])
def test_the_test_channel_is_a_mode(world: EmulationContext, dialect: str, params: tuple[int, ...]) -> None:
    session, space = idle(world, dialect)
    assert ask(session, space + "realtime.enableTestChannel", *params) == [0]
    assert ask(session, space + "system.getCurrentMode") == [0, "test channels enabled"]
    assert ask(session, space + "realtime.getTestChannelEnabled") == [0, True]
    assert ask(session, space + "system.startMeasurement")[0] != 0
    assert ask(session, space + "realtime.disableTestChannel") == [0]
    assert ask(session, space + "system.getCurrentMode") == [0, "system idle"]


@pytest.mark.parametrize("dialect", DIALECTS)
def test_the_network_is_described(world: EmulationContext, dialect: str) -> None:
    session, _ = idle(world, dialect, ip_address="192.0.2.7")
    for name, params in transcript.NETWORK_GETTERS.items():
        number, value = ask(session, transcript.NETWORK + name, *params)
        assert (name, number) == (name, 0)
        assert isinstance(value, str | bool)
    assert ask(session, transcript.NETWORK + "getRealIpAddress") == [0, "192.0.2.7"]


def test_a_network_configuration_is_verified_and_applied(world: EmulationContext) -> None:
    session, _ = idle(world)
    network = transcript.NETWORK
    for name, value in (("IpAddress", "192.0.2.9"), ("SubnetMask", "255.255.0.0"), ("ProxyServer", "proxy")):
        assert ask(session, f"{network}set{name}", value) == [0]
    assert ask(session, network + "setDnsResolver", 1, "192.0.2.53") == [0]
    assert ask(session, network + "setEnableDhcpClient", True) == [0]
    assert ask(session, network + "getIpAddress") == [0, "192.0.2.1"]
    assert ask(session, network + "verify") == [0]
    assert ask(session, network + "apply") == [0]
    assert ask(session, network + "getRealIpAddress") == [0, "192.0.2.9"]
    assert ask(session, network + "getDnsResolver", 1) == [0, "192.0.2.53"]
    assert ask(session, network + "getEnableDhcpClient") == [0, True]


@pytest.mark.parametrize(
    ("name", "params"),
    [
        ("setIpAddress", ("192.0.2",)),
        ("setSubnetMask", ("255.0.255.0",)),
        ("setDefaultGateway", ("gate",)),
        ("setDnsResolver", (0, "names")),
    ],
)
def test_a_wrong_network_configuration_is_not_applied(
    world: EmulationContext, name: str, params: tuple[object, ...]
) -> None:
    session, _ = idle(world)
    assert ask(session, transcript.NETWORK + name, *params) == [0]
    for step in ("verify", "apply"):
        (number,) = ask(session, transcript.NETWORK + step)
        assert "not valid" in ask(session, "com.attocube.system.errorNumberToString", 1, number)[1]
    assert ask(session, transcript.NETWORK + "discard") == [0]
    assert ask(session, transcript.NETWORK + "verify") == [0]


def test_without_a_radio_its_calls_are_refused(world: EmulationContext) -> None:
    session, _ = idle(world)
    network = transcript.NETWORK
    assert ask(session, network + "getWifiPresent") == [0, False]
    for name, params in (
        ("getWifiMode", ()),
        ("setWifiSSID", ("lab",)),
        ("configureWifi", (1, "lab", "key")),
    ):
        assert ask(session, network + name, *params)[0] != 0


def test_a_radio_is_configured_at_once(world: EmulationContext) -> None:
    session, _ = idle(world, wifi=True)
    network = transcript.NETWORK
    assert ask(session, network + "getWifiPresent") == [0, True]
    assert ask(session, network + "configureWifi", 1, "lab", "key") == [0]
    shown = [ask(session, f"{network}get{name}")[1] for name in ("WifiMode", "WifiSSID", "WifiPassphrase")]
    assert shown == [1, "lab", "key"]
    assert ask(session, network + "configureWifi", 2, "lab", "key")[0] != 0


@pytest.mark.parametrize("method", ["network.setIpAddress", "network.setWifiSSID"])
def test_a_text_that_is_none_is_an_invalid_parameter(world: EmulationContext, method: str) -> None:
    session, _ = idle(world, wifi=True)
    assert ask(session, f"com.attocube.system.{method}", 5)["code"] == -32602


@pytest.mark.parametrize(
    ("dialect", "analyse", "table"),
    [("ids", "estimateNonlinearities", "getLut"), ("sen", "analyzeNonlinearities", "getLutInPm")],
)
def test_a_table_is_created_while_the_measurement_waits(
    world: EmulationContext, dialect: str, analyse: str, table: str
) -> None:
    session, space = running(world, dialect, nlc_time_s=12.0)
    begun_s = world.beam_bench.time_s
    assert ask(session, f"{space}nlc.{table}", 0)[0] != 0
    for name in ("createLut", analyse):
        answer = send(session, f"{space}nlc.{name}", 0)
        assert not isinstance(answer, bytes)
        assert ask(session, space + "system.getCurrentMode") == [0, "measurement starting"]
        assert wait(world.beam_bench, answer) == [0]
    assert world.beam_bench.time_s == pytest.approx(begun_s + 24.0)
    assert ask(session, space + "system.getCurrentMode") == [0, "measurement running"]
    assert ask(session, f"{space}nlc.getLutStatus", 0) == [0, True]
    number, text = ask(session, f"{space}nlc.{table}", 0)
    assert (number, json.loads(text)) == (0, ZEROS)


@pytest.mark.parametrize("dialect", DIALECTS)
def test_no_table_is_created_unless_the_measurement_runs(world: EmulationContext, dialect: str) -> None:
    session, space = idle(world, dialect)
    (number,) = ask(session, space + "nlc.createLut", 0)
    assert "this mode" in ask(session, "com.attocube.system.errorNumberToString", 1, number)[1]
    assert ask(session, space + "nlc.setLutApplied", 0, True)[0] != 0


def test_no_table_is_found_without_a_beam(world: EmulationContext) -> None:
    session, space = running(world)
    answer = send(session, space + "nlc.createLut", 0)
    world.beam_bench.block_beam(None)
    assert wait(world.beam_bench, answer)[0] != 0
    assert ask(session, space + "nlc.getLutStatus", 0) == [0, False]
    assert wait(world.beam_bench, send(session, space + "nlc.createLut", 1))[0] != 0


def test_an_estimation_ends_with_the_measurement(world: EmulationContext) -> None:
    session, space = running(world)
    answer = send(session, space + "nlc.createLut", 0)
    assert ask(session, space + "system.stopMeasurement") == [0]
    assert ask(session, space + "system.startMeasurement") == [0]
    assert wait(world.beam_bench, answer)[0] != 0
    assert ask(session, space + "nlc.getLutStatus", 0) == [0, False]


def test_curves_exist_after_an_analysis_until_they_are_cleared(world: EmulationContext) -> None:
    session, space = running(world)
    names = ("ErrorCurve", "ErrorCurves", "ErrorList")
    methods = [f"{space}nlc.getNonlinearity{name}InPm" for name in names]
    assert all(ask(session, method, 0)[0] for method in methods)
    assert wait(world.beam_bench, send(session, space + "nlc.analyzeNonlinearities", 0)) == [0]
    curve, curves, peaks = (json.loads(ask(session, method, 0)[1]) for method in methods)
    assert curve == ZEROS
    assert [len(row) for row in curves] == [512] * len(peaks)
    assert ask(session, space + "nlc.getAnalysisStatus", 0) == [0, True]
    assert ask(session, space + "nlc.clearAll", 0) == [0]
    assert all(ask(session, method, 0)[0] for method in methods)


@pytest.mark.parametrize(("dialect", "suffix"), [("ids", "Lut"), ("sen", "LutInPm")])
def test_a_table_is_uploaded_and_applied(world: EmulationContext, dialect: str, suffix: str) -> None:
    session, space = idle(world, dialect)
    table = list(range(-256, 256))
    assert ask(session, f"{space}nlc.set{suffix}", 1, json.dumps(table)) == [0]
    assert json.loads(ask(session, f"{space}nlc.get{suffix}", 1)[1]) == table
    assert ask(session, f"{space}nlc.setLutApplied", 1, True) == [0]
    assert ask(session, f"{space}nlc.getLutApplied", 1) == [0, True]
    assert ask(session, f"{space}nlc.getLutApplied", 0) == [0, False]


@pytest.mark.parametrize("table", ["[1, 2]", json.dumps([0.5] * 512), json.dumps({"a": 1})])
def test_what_is_no_table_is_refused(world: EmulationContext, table: str) -> None:
    session, space = idle(world)
    assert ask(session, space + "nlc.setLutInPm", 0, table)[0] != 0


def test_normalization_modes_and_thresholds_are_kept(world: EmulationContext) -> None:
    session, space = idle(world, "ids")
    assert ask(session, space + "nlc.getVelocityThresholds") == [0, 10, 5]
    assert ask(session, space + "nlc.setVelocityThresholds", 20, 8) == [0]
    assert ask(session, space + "nlc.getVelocityThresholds") == [0, 20, 8]
    assert ask(session, space + "nlc.setVelocityThresholds", 5, 8)[0] != 0
    assert ask(session, space + "nlc.setDynamicNormalization", 2, 1) == [0]
    assert ask(session, space + "nlc.getDynamicNormalization", 2) == [0, 1]


def test_a_renormalization_takes_its_time(world: EmulationContext) -> None:
    session, space = running(world)
    world.beam_bench.beam.block(0.5)
    answer = send(session, space + "system.resetError", True)
    assert ask(session, space + "system.getCurrentMode") == [0, "measurement starting"]
    begun_s = world.beam_bench.time_s
    assert wait(world.beam_bench, answer) == [0]
    assert 14.0 <= world.beam_bench.time_s - begun_s <= 20.0
    assert ask(session, space + "displacement.getAxisDisplacement", 0)[0] == 0


def test_compensation_is_set_for_all_axes_at_once(world: EmulationContext) -> None:
    session, _ = idle(world)
    unit = "com.attocube.ecu."
    assert ask(session, unit + "setRefractiveIndexCompensationMode", -1, 2) == [0]
    assert ask(session, unit + "getRefractiveIndexCompensationMode", -1) == [0, 2]
    assert ask(session, unit + "getRefractiveIndexForCompensation", -1)[0] == 0
    assert ask(session, unit + "setRefractiveIndexCompensationMode", 0, 1)[0] != 0
    assert ask(session, unit + "setRefractiveIndexCompensationMode", -1, 3)[0] != 0


def test_parameters_may_be_optimized_during_a_start(world: EmulationContext) -> None:
    session, space = idle(world)
    assert ask(session, space + "system.getOptimizeParametersDuringInit") == [0, False]
    assert ask(session, space + "system.setOptimizeParametersDuringInit", True) == [0]
    assert ask(session, space + "system.getOptimizeParametersDuringInit") == [0, True]


def test_features_that_are_not_there_have_no_names(world: EmulationContext) -> None:
    session, space = idle(world)
    assert ask(session, space + "system.getNbrFeaturesActivated") == [0, 0]
    assert ask(session, space + "system.getFeaturesName", 0)[0] != 0


def test_an_idle_instrument_knows_of_no_lost_beam(world: EmulationContext) -> None:
    session, space = idle(world, start_time_s=0.0)
    world.beam_bench.block_beam(None)
    assert ask(session, space + "system.getSystemError") == [0]
    assert ask(session, space + "system.startOpticsAlignment") == [0]
    assert ask(session, space + "system.getSystemError")[0] != 0


def test_the_older_generation_answers_newer_names_too(world: EmulationContext) -> None:
    session, space = idle(world, "ids")
    for name in ("ecu.getEnabled", "ecu.getConnected"):
        assert ask(session, f"com.attocube.{name}")[0] == 0
    assert ask(session, space + "pilotlaser.getEnabled") == [0, False]


def test_requests_without_an_api_number_are_answered() -> None:
    session, _ = running(quiet_world(), "ids")
    for _ in range(2):
        session.feed(attocube_ids.EPICS_REQUEST)
        answer = session.answer()
        assert isinstance(answer, bytes)
        assert answer.count(b"\n") == 1
        said = json.loads(answer)
        assert (said["id"], said["result"][0], len(said["result"])) == (1, 0, 4)
