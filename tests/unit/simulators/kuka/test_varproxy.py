"""The proxy as its clients see it: the sheet's vectors, values, errors, several clients, a client of the field."""

import asyncio
import struct
from urllib.parse import urlsplit

import pytest
from py_openshowvar import openshowvar

from catseye.simulators.config import EmulatedDevice
from catseye.simulators.emulated_bench import EmulatedBench
from catseye.simulators.errors import EmulatorError
from catseye.simulators.kuka import varproxy
from catseye.simulators.kuka.frames import ErrorCode
from catseye.simulators.kuka.varproxy import VarproxySession
from catseye.simulators.ports.session import Pending
from tests.unit.simulators.benches import QUIET
from tests.unit.simulators.kuka.benches import UPRIGHT, kuka_bench
from tests.unit.simulators.kuka.client import Client, narrow, wide
from tests.unit.simulators.world.serial.arms import exact_arm

READ_MEASURED = bytes.fromhex("00 01 00 11 00 00 0E 24 41 58 49 53 5F 41 43 54 5F 4D 45 41 53")
WRITE_OVERRIDE = bytes.fromhex("00 02 00 0E 01 00 07 24 4F 56 5F 50 52 4F 00 02 35 30")


@pytest.fixture
def client() -> Client:
    return Client()


def test_the_sheets_vectors_are_answered(client: Client) -> None:
    reply = client.ask(READ_MEASURED)
    value = (
        b"{E6AXIS: A1 0.0, A2 -90.0, A3 90.0, A4 0.0, A5 30.0, A6 0.0, "
        b"E1 0.0, E2 0.0, E3 0.0, E4 0.0, E5 0.0, E6 0.0}"
    )
    body = b"\x00" + struct.pack(">H", len(value)) + value + b"\x00\x01\x01"
    assert reply == b"\x00\x01" + struct.pack(">H", len(body)) + body
    assert client.ask(WRITE_OVERRIDE) == bytes.fromhex("00 02 00 08 01 00 02 35 30 00 01 01")
    assert client.read("$OV_PRO") == "50"


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("$AXIS_ACT_MEAS.A2", "-90.0"),
        ("$axis_act.a3", "90.0"),
        ("$MODE_OP", "#EX"),
        ("$PRO_STATE", "#P_ACTIVE"),
        ("$PERI_RDY", "TRUE"),
        ("$VEL_AXIS_ACT[1]", "0.0"),
        ("$TORQUE_AXIS_ACT[6]", "0.0"),
        ("$MODEL_NAME[]", '"#KR210R2700 EMULATOR C4 FLR"'),
        ("$TOOL", "{FRAME: X 0.0, Y 0.0, Z 0.0, A 0.0, B 0.0, C 0.0}"),
        ("$POS_ACT.S", "2"),
        (
            "$LOAD",
            "{LOAD: M 0.0, CM {FRAME: X 0.0, Y 0.0, Z 0.0, A 0.0, B 0.0, C 0.0}, J {INERTIA: X 0.0, Y 0.0, Z 0.0}}",
        ),
        ("$LOAD.CM.X", "0.0"),
        ("$AXIS_INC.A1", "0"),
        ("CATS_FOR", "0"),
        ("PING", "PONG"),
        ("@PROXY_TYPE", "C3 BRIDGE INTERFACE"),
    ],
)
def test_values_have_the_form_of_their_type(client: Client, name: str, text: str) -> None:
    assert client.read(name) == text


def test_values_fit_into_the_buffer_of_a_small_client(client: Client) -> None:
    client.emulation.controller.variables.write("$TOOL", "{X -1234.567,Y -1234.567,Z -1234.567,A 1.234567}")
    for name in ("$AXIS_ACT", "$POS_ACT", "$POS_ACT_MEAS", "$TOOL"):
        assert len(client.read(name)) <= 246


@pytest.mark.parametrize(
    "name",
    [
        "$NOTHING",
        "$AXIS_ACT.Q1",
        "$AXIS_ACT.A1.X",
        "$LOAD.M.X",
        "$LOAD.CM.Q",
        "$OV_PRO.A1",
        "$OV_PRO[1]",
        "$TORQUE_AXIS_ACT[7]",
        "",
        "ping",
        "@X",
    ],
)
def test_an_unknown_variable_is_an_error(client: Client, name: str) -> None:
    assert client.say(0, narrow(name)) == (b"\x00\x00", ErrorCode.GENERAL, 0)
    assert client.say(4, wide(name)) == (b"\x00\x00", ErrorCode.ARGUMENT, 0)


@pytest.mark.parametrize(
    ("name", "text", "error"),
    [
        ("$AXIS_ACT", "{A1 1.0}", ErrorCode.ACCESS),
        ("$MODE_OP", "#T1", ErrorCode.ACCESS),
        ("$OV_PRO", "101", ErrorCode.ARGUMENT),
        ("$OV_PRO", "ten", ErrorCode.ARGUMENT),
        ("$OV_PRO", "10.5", ErrorCode.ARGUMENT),
        ("$LOAD", "{CM {Q 1.0}}", ErrorCode.ARGUMENT),
        ("$LOAD", "{CM 1.0}", ErrorCode.ARGUMENT),
        ("$AXIS_INC", "{A1 1}", ErrorCode.ACCESS),
        ("CATS_STOP", "1", ErrorCode.ARGUMENT),
        ("CATS_GOAL", "{Q1 1.0}", ErrorCode.ARGUMENT),
        ("CATS_INC", "1e99", ErrorCode.ARGUMENT),
        ("CATS_SEQ", "99999999999", ErrorCode.ARGUMENT),
    ],
)
def test_a_value_that_cannot_be_written_is_an_error(
    client: Client, name: str, text: str, error: ErrorCode
) -> None:
    before = client.emulation.controller.variables.read(name)
    assert client.say(1, narrow(name) + narrow(text)) == (b"\x00\x00", ErrorCode.GENERAL, 0)
    assert client.say(5, wide(name) + wide(text)) == (b"\x00\x00", error, 0)
    assert client.emulation.controller.variables.read(name) == before


def test_members_that_a_text_leaves_out_keep_their_values(client: Client) -> None:
    client.say(1, narrow("$BASE") + narrow("{X 1.5, Z -2}"))
    client.say(1, narrow("$BASE.Y") + narrow("3"))
    assert client.read("$BASE") == "{FRAME: X 1.5, Y 3.0, Z -2.0, A 0.0, B 0.0, C 0.0}"


def test_members_of_members_are_written(client: Client) -> None:
    client.say(1, narrow("$LOAD") + narrow("{M 12.5, CM {X 1.0, Z 2.0}}"))
    client.say(1, narrow("$LOAD.J.Y") + narrow("0.5"))
    client.say(1, narrow("$LOAD.CM") + narrow("{FRAME: X 3.0}"))
    assert client.read("$LOAD") == (
        "{LOAD: M 12.5, CM {FRAME: X 3.0, Y 0.0, Z 2.0, A 0.0, B 0.0, C 0.0}, J {INERTIA: X 0.0, Y 0.5, Z 0.0}}"
    )


def test_encoder_counts_are_those_of_the_measured_axes(client: Client) -> None:
    shown = client.read("$AXIS_INC")
    assert shown.startswith("{AXIS_INC: A1 0, A2 -")
    assert shown.endswith(", E5 0, E6 0}")
    # A2 stands at -90° and A3 at 90°: what one count is, by the gears and encoders of the arm's description.
    for axis, joint in zip(("A2", "A3"), exact_arm("kr210-r2700").joints[1:3], strict=True):
        assert joint.gear_ratio is not None
        turn = 2 ** (joint.encoder_bits or 17)
        measured_deg = float(client.read(f"$AXIS_ACT_MEAS.{axis}"))
        counts = int(client.read(f"$AXIS_INC.{axis}"))
        assert counts == pytest.approx(measured_deg / 360.0 * joint.gear_ratio * turn, rel=1e-6)


def test_reals_have_32_bits(client: Client) -> None:
    client.say(1, narrow("CATS_INC") + narrow("0.1000000001"))
    assert client.read("CATS_INC") == "0.1"


def test_several_variables_are_read_at_once(client: Client) -> None:
    payload, error, success = client.say(6, b"\x03" + wide("$OV_PRO") + wide("$NO") + wide("PING"))
    assert (error, success) == (ErrorCode.GENERAL, 0)
    assert payload == b"\x03\x01" + wide("100") + b"\x03" + wide("") + b"\x01" + wide("PONG")


def test_several_variables_are_written_and_read_back(client: Client) -> None:
    payload, error, success = client.say(
        7, b"\x02" + wide("$OV_PRO") + wide(" 7 ") + wide("CATS_INC") + wide("2")
    )
    assert (payload, error, success) == (b"\x02\x01" + wide("7") + b"\x01" + wide("2.0"), 1, 1)


@pytest.mark.parametrize("kind", [2, 3, 10, 11, 12, 13, 20, 50, 63, 255])
def test_other_types_are_not_implemented(client: Client, kind: int) -> None:
    assert client.say(kind, b"\x00\x01A") == (b"", ErrorCode.NOT_IMPLEMENTED, 0)


@pytest.mark.parametrize("kind", [4, 5, 6, 7, 10])
def test_an_old_proxy_says_nothing_to_other_types(kind: int) -> None:
    assert Client(old=True).ask(struct.pack(">HHB", 5, 3, kind) + b"AB") == b"\x00\x05\x00\x00"


def test_an_old_proxy_has_a_footer_of_its_own() -> None:
    """The footers are those that its published source writes: the length of the success byte, and that byte."""
    old = Client(old=True)
    assert old.say(0, narrow("PING")) == (narrow("PONG"), 1, 1)
    assert old.say(0, narrow("$NOBODY")) == (narrow(""), 1, 1)
    assert old.say(0, narrow("@PROXY_TYPE")) == (narrow(""), 1, 1)
    assert old.say(1, narrow("$MODE_OP") + narrow("#T1")) == (narrow("#T1"), 1, 0)
    assert old.say(1, narrow("$OV_PRO") + narrow("30")) == (narrow("30"), 1, 1)


def test_an_old_proxy_ignores_bytes_behind_a_request() -> None:
    """A client in C# sends a zero behind every request to read (KukavarProxyTestPrograms, Kukavarproxy.cs)."""
    old = Client(old=True)
    for _ in range(3):
        assert old.ask(READ_MEASURED + b"\x00").endswith(b"\x00\x01\x01")


async def test_an_old_proxy_closes_an_idle_connection(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(varproxy, "OLD_IDLE_S", 0.2)
    async with kuka_bench(options={"old_proxy": True}) as bench:
        link = urlsplit(bench.endpoints[0].endpoint)
        reader, writer = await asyncio.open_connection(link.hostname, link.port)
        for _ in range(3):
            # Each request counts anew.
            writer.write(READ_MEASURED)
            await reader.readexactly(5)
        async with asyncio.timeout(10.0):
            assert (await reader.read())[-1:] == b"\x01"
        writer.close()


def test_only_an_old_proxy_minds_silence(client: Client) -> None:
    assert client.session.silence_s() is None
    # More than 30 s, looked for once a second.
    assert Client(old=True).session.silence_s() == 31.0


def test_a_busy_old_proxy_can_lose_what_comes() -> None:
    old = Client(old=True)
    old.proxy.loses = True
    other = VarproxySession(old.proxy, old.requests.append)
    old.session.feed(READ_MEASURED)
    first = old.session.answer()
    other.feed(WRITE_OVERRIDE)
    assert other.answer() is None
    assert isinstance(first, Pending)
    old.bench.advance(0.1)
    assert first.due() is None
    assert old.requests == ["lost: reading pending", "read $AXIS_ACT_MEAS"]
    assert other.answer() is None
    # Nobody answers what was lost; the next request is carried out.
    other.feed(WRITE_OVERRIDE)
    assert isinstance(other.answer(), Pending)


def test_an_old_proxy_loses_a_request_in_two_pieces() -> None:
    old = Client(old=True)
    old.session.feed(READ_MEASURED[:9])
    assert old.session.answer() is None
    assert old.ask(READ_MEASURED).endswith(b"\x00\x01\x01")


@pytest.mark.parametrize("old", [False, True])
def test_requests_that_come_together_are_answered_in_turn(old: bool) -> None:
    client = Client(old=old)
    client.session.feed(WRITE_OVERRIDE + READ_MEASURED)
    tags = []
    while isinstance(answer := client.session.answer(), Pending):
        client.bench.advance(0.02)
        tags.append(answer.reply()[:2])
    assert tags == [b"\x00\x02", b"\x00\x01"]


@pytest.mark.parametrize("old", [False, True])
def test_odd_bytes_in_a_name_are_an_unknown_variable(old: bool) -> None:
    odd = "Ä\x00\xff".encode("latin-1")
    payload, _, _ = Client(old=old).say(0, struct.pack(">H", len(odd)) + odd)
    assert payload == narrow("")


def test_an_answer_that_is_too_long_is_an_error() -> None:
    small = Client(longest_bytes=100)
    payload, error, success = small.say(6, b"\x02" + 2 * wide("$AXIS_ACT"))
    assert (payload, error, success) == (b"\x00", ErrorCode.LONG_ANSWER, 0)


@pytest.mark.parametrize(
    ("kind", "payload", "reply"),
    [
        (0, b"\x00\x09abc", (b"\x00\x00", ErrorCode.GENERAL, 0)),
        (1, b"\x00\x01a", (b"\x00\x00", ErrorCode.GENERAL, 0)),
        (4, b"\x00\x02ab", (b"\x00\x00", ErrorCode.PROTOCOL, 0)),
        (6, b"\x05", (b"\x00", ErrorCode.PROTOCOL, 0)),
        (7, b"", (b"\x00", ErrorCode.PROTOCOL, 0)),
    ],
)
def test_a_payload_that_is_cut_off_is_an_error(
    client: Client, kind: int, payload: bytes, reply: tuple[bytes, int, int]
) -> None:
    assert client.say(kind, payload) == reply


@pytest.mark.parametrize("cut", [wide("CATS_INC"), b"\x00", b""])
def test_of_writes_that_are_cut_off_none_is_carried_out(client: Client, cut: bytes) -> None:
    before = client.say(0, narrow("$OV_PRO"))
    payload = b"\x02" + wide("$OV_PRO") + wide("23") + cut
    assert client.say(7, payload)[:2] == (b"\0", ErrorCode.PROTOCOL)
    assert client.say(0, narrow("$OV_PRO")) == before


def test_a_request_takes_five_to_fifteen_milliseconds(client: Client) -> None:
    started_s = client.bench.time_s
    for _ in range(50):
        client.read("PING")
    assert 0.25 < client.bench.time_s - started_s < 0.75


def test_clients_wait_for_each_other() -> None:
    first = Client()
    other = VarproxySession(first.proxy, first.requests.append)
    turns = []
    for session in (first.session, other):
        session.feed(READ_MEASURED)
        answer = session.answer()
        assert isinstance(answer, Pending)
        due_s = answer.due()
        assert due_s is not None
        turns.append(due_s)
    assert turns[1] - turns[0] >= 0.005


def test_what_a_client_sent_before_it_went_is_carried_out(client: Client) -> None:
    client.session.feed(WRITE_OVERRIDE * 2)
    client.session.close()
    client.bench.advance(0.1)
    assert client.emulation.controller.variables.read("$OV_PRO") == "50"
    assert client.requests == ["write $OV_PRO = 50"] * 2


def test_a_request_in_pieces_is_answered_once_it_is_whole(client: Client) -> None:
    for byte in READ_MEASURED[:-1]:
        client.session.feed(bytes([byte]))
        assert client.session.answer() is None
    assert client.ask(READ_MEASURED[-1:]).endswith(b"\x00\x01\x01")


def test_a_bench_without_a_kuka_has_no_proxy() -> None:
    device = EmulatedDevice("robot", "kuka-varproxy")
    with pytest.raises(EmulatorError, match="no KUKA controller"):
        EmulatedBench(type(QUIET)(QUIET.reflectors, devices=(device,)))


async def test_a_public_client_leads_the_emulator_unmodified() -> None:
    async with kuka_bench() as bench:
        port = urlsplit(bench.endpoints[0].endpoint).port
        assert port is not None
        assert await asyncio.to_thread(led_by_openshowvar, port) == {
            "axes": tuple(UPRIGHT),
            "override": b"20",
            "unknown": None,
            "protected": None,
            "mode": b"#EX",
        }


def led_by_openshowvar(port: int) -> dict[str, object]:
    """Do what scripts in the field do."""
    client = openshowvar("127.0.0.1", port)
    try:
        text = client.read("$AXIS_ACT", debug=False).decode()
        members = dict(part.split() for part in text.strip("{}").removeprefix("E6AXIS: ").split(", "))
        assert client.write("$OV_PRO", "20", debug=False) == b"20"
        return {
            "axes": tuple(float(members[f"A{number}"]) for number in range(1, 7)),
            "override": client.read("$OV_PRO", debug=False),
            "unknown": client.read("$NOBODY", debug=False),
            "protected": client.write("$MODE_OP", "#T1", debug=False),
            "mode": client.read("$MODE_OP", debug=False),
        }
    finally:
        client.close()
