"""What robots and trackers lose with their power, and what they keep."""

import struct
from collections.abc import Callable

import pytest

from catseye.simulators.control_port import faults
from catseye.simulators.control_port.messages import PressKey
from catseye.simulators.control_port.operations import carry_out
from catseye.simulators.control_port.survey_messages import LeadTracker
from catseye.simulators.emulated_bench import EmulatedBench, ServedBench
from catseye.simulators.errors import EmulatorError
from catseye.simulators.melfa.datalink import Datalink
from catseye.simulators.melfa.r_protocol import MelfaSession
from catseye.simulators.melfa.resident import Stage
from tests.unit.simulators.abb.benches import abb_bench
from tests.unit.simulators.benches import QUIET
from tests.unit.simulators.kuka.benches import UPRIGHT, kuka_bench
from tests.unit.simulators.trackers import Client, near, tracker_bench

OFF_S = 20.0


def cut(bench: ServedBench, device: str = "robot") -> None:
    """Let a device lose its power for a while."""
    carry_out(faults.CutPower(device=device, duration_s=OFF_S), bench.reach)


@pytest.mark.parametrize("make", ["melfa", "kuka", "abb"])
def test_without_power_brakes_hold_the_arm(make: str) -> None:
    benches: dict[str, Callable[[], ServedBench]] = {
        "melfa": lambda: EmulatedBench(QUIET),
        "kuka": kuka_bench,
        "abb": abb_bench,
    }
    bench = benches[make]()
    moved = bench.context.bench
    start = moved.joints
    moved.move_to((start[0] + 60.0, *start[1:]), 10.0)
    moved.advance(1.0)
    cut(bench)
    moved.advance(5.0)
    stands = moved.joints
    assert start[0] < stands[0] < start[0] + 59.0
    moved.advance(1000.0)
    assert moved.joints == stands
    assert not bench.context.controller.servo_on


def ask(bench: EmulatedBench, *requests: str) -> list[str]:
    """Put requests to a MELFA controller as a new client; return its answers."""
    session = MelfaSession(bench.controller, "", lambda _text: None)
    session.feed("".join(f"1;1;{request}\r" for request in requests).encode())
    answers = []
    while (answer := session.answer()) is not None:
        assert isinstance(answer, bytes)
        answers.append(answer.decode())
    return answers


def test_a_melfa_forgets_right_stop_and_override() -> None:
    bench = EmulatedBench(QUIET)
    asked = ask(bench, "OPEN=TEST", "CNTLON", "OVRD=15", "STOPON", "EXECDEF JNT JX")
    assert all(answer.startswith("QoK") for answer in asked)
    cut(bench)
    bench.bench.advance(OFF_S)
    assert ask(bench, "OVRD", "STPSIG", "SRVON") == ["QoK100", "QoK0;0", "QeR602000000"]
    assert not bench.controller.right_holders
    assert not bench.controller.variables


def test_a_melfa_keeps_its_log_and_the_emergency_stop() -> None:
    controller = (bench := EmulatedBench(QUIET)).controller
    controller.raise_alarm(2600)
    controller.set_emergency_stop(on=True)
    controller.alarm = 2600
    cut(bench)
    assert controller.alarm == 50
    assert [line.number for line in controller.log] == [2600, 50, 50]


def test_an_alarm_is_gone_with_the_power() -> None:
    bench = EmulatedBench(QUIET)
    bench.controller.raise_alarm(2600)
    cut(bench)
    assert bench.controller.alarm == 0


def test_a_resident_program_waits_at_its_top() -> None:
    bench = EmulatedBench(QUIET)
    bench.controller.install(Datalink(bench.controller))
    cut(bench)
    bench.controller.install(Datalink(bench.controller))
    assert bench.controller.residents["CATSDL"].stage is Stage.AT_TOP


def test_a_kuka_starts_cold_with_no_program_selected() -> None:
    bench = kuka_bench()
    read = bench.controller.variables.read
    carry_out(PressKey(key="T1"), bench.reach)
    bench.controller.control.set_override(10)
    bench.controller.raise_alarm(7)
    cut(bench)
    shown = {name: read(name) for name in ("$PRO_STATE", "$PERI_RDY", "$STOPMESS", "$OV_PRO", "$MODE_OP")}
    assert shown == {
        "$PRO_STATE": "#P_FREE",
        "$PERI_RDY": "FALSE",
        "$STOPMESS": "FALSE",
        "$OV_PRO": "100",
        "$MODE_OP": "#T1",
    }


def test_a_kuka_moves_only_once_it_is_asked_anew() -> None:
    bench = kuka_bench()
    bench.controller.control.go(lambda _override: bench.bench.move_to((60.0, *UPRIGHT[1:]), 10.0))
    bench.bench.advance(0.5)
    cut(bench)
    bench.bench.advance(OFF_S)
    stands = bench.bench.joints
    carry_out(PressKey(key="drives"), bench.reach)
    with pytest.raises(EmulatorError, match="none is selected"):
        carry_out(PressKey(key="start"), bench.reach)
    for key in ("reset", "start"):
        carry_out(PressKey(key=key), bench.reach)
    bench.bench.advance(10.0)
    assert bench.controller.variables.read("$PRO_STATE") == "#P_ACTIVE"
    assert bench.bench.joints == stands


def test_an_abb_keeps_files_and_forgets_sessions() -> None:
    bench = abb_bench()
    bench.controller.files["a"] = b"b"
    bench.controller.signals["x"] = "1"
    bench.controller.control.set_override(10)
    bench.controller.raise_alarm(1)
    cut(bench)
    control = bench.controller.control
    assert (control.state, control.override_percent) == ("motoroff", 100)
    assert not bench.controller.program.running
    assert bench.controller.files
    assert not bench.controller.signals


def test_an_open_guard_stays_open_without_power() -> None:
    bench = abb_bench()
    carry_out(PressKey(key="guard"), bench.reach)
    cut(bench)
    assert bench.controller.control.state == "guardstop"


def test_a_dark_panel_has_no_keys() -> None:
    bench = kuka_bench()
    cut(bench)
    with pytest.raises(EmulatorError, match="robot has no power"):
        carry_out(PressKey(key="drives"), bench.reach)
    bench.keeper.speed = 1e9
    bench.bench.advance(OFF_S)
    carry_out(PressKey(key="drives"), bench.reach)
    assert bench.controller.servo_on


def emscon(client: Client, number: int, data: bytes = b"", wait_s: float = 10.0) -> tuple[int, ...]:
    """Give an emScon command; return status and the whole numbers behind it."""
    said = client.say(struct.pack("<iii", 12 + len(data), 0, number) + data) or client.wait(wait_s)
    while struct.unpack_from("<iii", said)[1:] != (0, number):
        said = said[struct.unpack_from("<i", said)[0] :]
    size = struct.unpack_from("<i", said)[0]
    return struct.unpack(f"<{size // 4 - 3}i", said[12:size])


def test_a_leica_needs_warmth_and_initialisation_again() -> None:
    bench = tracker_bench("leica-emscon", options={"initialised": True, "warm_again_s": 100.0})
    client = Client(bench)
    assert (emscon(client, 1)[2], emscon(client, 1)[3]) == (5, 3)
    cut(bench, "tracker")
    client.wait(OFF_S)
    client.another()
    assert (emscon(client, 1)[2], emscon(client, 1)[3]) == (4, 2)
    assert emscon(client, 49)[0] == 39
    client.wait(100.0)
    assert emscon(client, 1)[3] == 3
    assert emscon(client, 7)[0] == 0
    assert emscon(client, 1)[2] == 5


def test_a_leicas_order_ends_with_its_power() -> None:
    bench = tracker_bench("leica-emscon", options={"initialised": True})
    client = Client(bench)
    client.say(struct.pack("<iii3di", 40, 0, 55, *near_m(bench), 1))
    cut(bench, "tracker")
    bench.bench.advance(10.0)
    assert not bench.bench.tracker.locked


def near_m(bench: ServedBench) -> tuple[float, float, float]:
    x, y, z = near(bench, "nest1")  # type: ignore[arg-type]  # the bench of a serial arm
    return 1e-3 * x, 1e-3 * y, 1e-3 * z


def test_a_t2sa_has_no_laser_and_no_points_then() -> None:
    bench = tracker_bench("t2sa", options={"point_s": 1.0, "warm_up_s": 60.0})
    client = Client(bench)
    client.say(b"!MEAS_SINGLE_POINT:c;g;nest1\r\n")
    assert b"ACK" in client.wait(2.0)
    cut(bench, "tracker")
    client.wait(OFF_S)
    client.another()
    assert client.say(b"?LSTA\r\n") == b"ACK-300 LOFF\r\n"
    assert b"ERR" in client.say(b"?POINT_POS:c;g;nest1\r\n")
    client.say(b"!LST:1\r\n")
    assert b"WARM" in client.say(b"?LSTA\r\n")


def test_hands_lead_no_beam_of_a_dark_tracker() -> None:
    bench = tracker_bench("leica-emscon")
    cut(bench, "tracker")
    with pytest.raises(EmulatorError, match="tracker has no power"):
        carry_out(LeadTracker(target="nest1"), bench.reach)
