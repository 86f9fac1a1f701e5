"""R-protocol telegrams against the transcripts of the protocol sheet (sections given at each test)."""

from collections.abc import Sequence
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.drivers.melfa import codec
from catseye.drivers.melfa.codec import Answer, AnswerDecoder, Layout
from catseye.drivers.roles.errors import ProtocolError

# Sheet 1.8, first capture; the copyright text is left open there.
OPEN_RV1A = (
    "3F;3F;7,0;3,5,A,1E,32,46,64;MB4;PRM;RV-1A;CRn-5xx;MELFA;09-08-08;Ver.K9b;ENG;COPYRIGHT(C) someone;1;1;8;"
)
# Sheet 1.10, examples.
STATE_IDLE = "QoK;0;100;0;01120;0;1;;;;;;;;;REP;START;1;0"
STATE_PROGRAM = "QoKKAMAL.MB4;1196;50;4;08860;1196;1;;;;;;;;;REP;START;1;0"
# Sheet 1.10: composite `A1124220` with the prefix of 1.6 that goes with an alarm.
STATE_ALARM = "Qok;0;100;0;A1124220;0;1;;;;;;;;;REP;START;1;0"
# Sheet 1.11, captures.
JPOS_6 = "QoKJ1;-16.28;J2;38.72;J3;102.51;J4;16.73;J5;6.06;J6;-19.16;;****,****;75;0.00;00000000"
JPOS_8 = "QokJ1;0.00;J2;0.00;J3;0.00;J4;0.00;J5;0.00;J6;0.00;J7;0.00;J8;0.00;;****,****;100;0.00;00000000"
PPOS = "QoKX;351.84;Y;-100.49;Z;366.25;A;179.89;B;33.00;C;166.72;;7,0;75;0.00;00000000"

TRANSCRIPTS: list[tuple[str, Layout]] = [
    ("QoK", codec.bare),
    ("Qok", codec.bare),
    ("QoK" + OPEN_RV1A, codec.open_text),
    (STATE_IDLE, codec.state_text),
    (STATE_PROGRAM, codec.state_text),
    (STATE_ALARM, codec.state_text),
    (JPOS_6, codec.positions_text),
    (JPOS_8, codec.positions_text),
    (PPOS, codec.positions_text),
    ("Qok4140;2", codec.error_text),
    ("QeR602000000", codec.bare),
    ("QeR512000000", codec.state_text),
]


def chunks_of(data: bytes, cuts: Sequence[int]) -> list[bytes]:
    edges = [0, *sorted({cut % (len(data) + 1) for cut in cuts}), len(data)]
    return [data[a:b] for a, b in pairwise(edges) if a < b]


def decode(chunks: Sequence[bytes], layout: Layout, *, terminated: bool = False) -> Answer | None:
    """Feed chunks until there is an answer."""
    decoder = AnswerDecoder(layout, terminated=terminated)
    for chunk in chunks:
        if answer := decoder.feed(chunk):
            return answer
    return None


def test_request_bytes_of_the_sheet() -> None:
    """Section 1.5, byte example."""
    assert codec.encode("DELETE10;50", terminator="").hex(" ").upper() == (
        "31 3B 31 3B 44 45 4C 45 54 45 31 30 3B 35 30"
    )


def test_request_header_and_terminator() -> None:
    """Sections 1.2 and 1.5."""
    assert codec.encode("PPOSF", slot=-1) == b"1;-1;PPOSF\r"
    assert codec.encode("STOP", robot=0, slot=9, terminator="\r\n") == b"0;9;STOP\r\n"


def test_request_is_at_most_255_bytes() -> None:
    """Section 1.1."""
    assert len(codec.encode("X" * 251, terminator="")) == 255
    with pytest.raises(ValueError, match="at most 255"):
        codec.encode("X" * 252)


@pytest.mark.parametrize("command", ["STATE\r1;1;SRVON", "PPOS\n", "µ", "\x00"])
def test_request_takes_one_line_of_ascii_only(command: str) -> None:
    with pytest.raises(ValueError, match="printable ASCII"):
        codec.encode(command)


@pytest.mark.parametrize("suffix", ["", "\r", "\r\n", "\n"])
@pytest.mark.parametrize(("text", "layout"), TRANSCRIPTS)
def test_controllers_of_every_kind_are_understood(text: str, layout: Layout, suffix: str) -> None:
    """Section 1.2: TCP answers end with nothing, CR or CR LF."""
    answer = decode([(text + suffix).encode()], layout)
    assert answer
    assert answer.payload == text[3:]
    assert answer.terminated == bool(suffix)


@pytest.mark.parametrize(("text", "layout"), TRANSCRIPTS)
def test_a_split_answer_without_terminator_is_not_taken_for_complete(text: str, layout: Layout) -> None:
    for cut in range(1, len(text)):
        decoder = AnswerDecoder(layout)
        assert decoder.feed(text[:cut].encode()) is None, text[:cut]
        done = decoder.feed(text[cut:].encode())
        assert done
        assert done.payload == text[3:]


@given(
    case=st.sampled_from(TRANSCRIPTS),
    suffix=st.sampled_from(["", "\r", "\r\n", "\n"]),
    cuts=st.lists(st.integers(0, 200), max_size=12),
)
def test_any_split_gives_the_same_answer(case: tuple[str, Layout], suffix: str, cuts: list[int]) -> None:
    text, layout = case
    whole = decode([(text + suffix).encode()], layout)
    parts = decode(chunks_of((text + suffix).encode(), cuts), layout)
    assert whole
    assert parts
    assert (parts.accepted, parts.alarm, parts.number, parts.payload) == (
        whole.accepted,
        whole.alarm,
        whole.number,
        whole.payload,
    )


@given(
    text=st.from_regex(r"\AQo[Kk][ -~]{0,40}\Z"),
    end=st.sampled_from(["\r", "\r\n"]),
    cuts=st.lists(st.integers(0, 60), max_size=8),
)
def test_once_a_terminator_is_known_nothing_else_ends_an_answer(text: str, end: str, cuts: list[int]) -> None:
    """`QoK10` + `0` CR is 100, not 10: what the layout does not show, the terminator does."""
    parts = decode(chunks_of((text + end).encode(), cuts), codec.free_text, terminated=True)
    assert parts
    assert parts.payload == text[3:]


def test_what_cannot_be_known_ends_with_silence() -> None:
    """A number shows no end: the decoder offers what it has and leaves the time to the link."""
    decoder = AnswerDecoder(codec.free_text)
    assert decoder.feed(b"QoK10") is None
    assert decoder.may_end
    assert decoder.feed(b"0") is None
    assert decoder.end().payload == "100"


def test_silence_does_not_end_an_incomplete_answer() -> None:
    decoder = AnswerDecoder(codec.state_text)
    assert decoder.feed(STATE_IDLE[:-1].encode()) is None
    assert not decoder.may_end


def test_bytes_behind_an_answer_are_handed_back() -> None:
    decoder = AnswerDecoder(codec.bare)
    assert decoder.feed(b"QoK\r\nQoKagain\r")
    assert decoder.rest == b"QoKagain\r"


def test_a_late_terminator_before_an_answer_is_skipped() -> None:
    answer = decode([b"\n", b"\r", b"QoK\r"], codec.bare)
    assert answer == Answer(accepted=True, alarm=False, number=0, payload="", terminated=True)


@pytest.mark.parametrize(
    ("text", "number"),
    [
        ("QeR602000000", 6020),  # section 1.6, capture: no operation right
        ("QeR512000000", 5120),  # section 1.6, capture: slot not selectable
        ("QeR6020", 6020),  # section 1.6: four digits as the specification has it
        ("Qer4340;12", 4340),  # section 1.6: editing commands add a position
        ("qER6010", 6010),  # section 1.6: clients must compare case-insensitively
    ],
)
def test_rejections(text: str, number: int) -> None:
    answer = codec.parse_answer(text.encode(), terminated=True)
    assert (answer.accepted, answer.number) == (False, number)


@pytest.mark.parametrize(("prefix", "alarm"), [("QoK", False), ("Qok", True), ("qoK", False)])
def test_the_third_letter_flags_an_alarm(prefix: str, alarm: bool) -> None:
    """Section 1.6, likely."""
    assert codec.parse_answer(prefix.encode(), terminated=True).alarm is alarm


@pytest.mark.parametrize(
    "data",
    [
        b"SSH-2.0-OpenSSH_9.2\r\n",
        b"HTTP/1.1 400 Bad Request\r\n",
        b"1;1;OPEN=CATSEYE\r",
        b"+000012.345678 mm\r\n",
        b"Qx",
        b"QoX",
        b"Q\x00",
        b"QoK\x02\x03",
        b"QeR12\r",
        b"\xff\xfe",
    ],
)
def test_what_no_controller_says_is_refused(data: bytes) -> None:
    with pytest.raises(ProtocolError):
        AnswerDecoder(codec.free_text).feed(data)


def test_an_answer_without_end_is_refused_and_memory_is_bounded() -> None:
    decoder = AnswerDecoder(codec.state_text)
    assert decoder.feed(b"QoK" + b";" * (codec.MAX_ANSWER_BYTES - 3)) is None
    with pytest.raises(ProtocolError, match="does not end"):
        decoder.feed(b";")


LAYOUTS: list[Layout] = [
    codec.bare,
    codec.open_text,
    codec.state_text,
    codec.positions_text,
    codec.error_text,
    codec.free_text,
]


@given(
    chunks=st.lists(
        st.binary(max_size=40) | st.sampled_from([b"QoK", b"QeR", b";", b"\r", b"1;2"]), max_size=10
    ),
    layout=st.sampled_from(LAYOUTS),
    terminated=st.booleans(),
)
def test_garbage_raises_nothing_but_protocol_errors(
    chunks: list[bytes], layout: Layout, terminated: bool
) -> None:
    decoder = AnswerDecoder(layout, terminated=terminated)
    answer: Answer | None = None
    try:
        for chunk in chunks:
            answer = decoder.feed(chunk)
            if answer:
                break
        if not answer and decoder.may_end:
            answer = decoder.end()
    except ProtocolError:
        return
    assert answer is None or isinstance(answer.payload, str)


@given(st.text(max_size=80) | st.from_regex(r"\A(J\d;-?\d+\.\d\d;){0,9};\*\*;1;2;0{8}\Z"))
def test_parsers_raise_nothing_but_protocol_errors(payload: str) -> None:
    parsers = (codec.parse_open, codec.parse_state, codec.parse_positions, codec.parse_error)
    refused = 0
    for parse in parsers:
        try:
            parse(payload)
        except ProtocolError:
            refused += 1
    assert refused >= len(parsers) - 1, "no text is an answer to two questions"


def test_open_fields() -> None:
    """Section 1.8, capture of an RV-1A."""
    opened = codec.parse_open(OPEN_RV1A)
    assert (opened.joints, opened.model, opened.controller, opened.series) == (
        0x3F,
        "RV-1A",
        "CRn-5xx",
        "MELFA",
    )
    assert (opened.firmware, opened.copyright, opened.serial) == ("Ver.K9b", "COPYRIGHT(C) someone", "1")


def test_open_without_its_tail_still_names_the_robot() -> None:
    opened = codec.parse_open(OPEN_RV1A.rsplit(";", 4)[0])
    assert (opened.model, opened.serial) == ("RV-1A", "")


@pytest.mark.parametrize("payload", ["", "3F;3F", ";;;;;;;;;;;;;;;", "a;zz;c;d;e;f;g;h;i;j;k;l;m"])
def test_open_of_something_else(payload: str) -> None:
    with pytest.raises(ProtocolError, match="OPEN was answered by"):
        codec.parse_open(payload)


@pytest.mark.parametrize(
    ("flags", "true"),
    [
        # Section 1.10, observed composites.
        ("01120", set()),  # idle, repeat, STOP and program selection
        ("09060", {"teach_mode"}),  # repeat, TEACH, STOP and WAIT
        ("20060", {"servo_on"}),  # servo on, paused
        ("A0060", {"operation_enabled", "servo_on"}),  # operation right, servo, paused
        ("80060", {"operation_enabled"}),
        ("08860", {"teach_mode"}),
        ("60000", {"servo_on", "running"}),  # servo on and running
        ("A1124220", {"operation_enabled", "servo_on"}),  # A1, 12, error 4220
        ("04010", {"machine_locked", "emergency_stop"}),  # bit table: run status 04
        ("00010", {"emergency_stop"}),  # bit table: stop status 01
    ],
)
def test_state_bits(flags: str, true: set[str]) -> None:
    state = codec.parse_state(f";0;100;0;{flags};0;1;;;;;;;;;REP;START;1;0")
    names = {"servo_on", "running", "operation_enabled", "teach_mode", "machine_locked", "emergency_stop"}
    assert {name for name in names if getattr(state, name)} == true


def test_state_fields() -> None:
    """Section 1.10, examples."""
    state = codec.parse_state(STATE_PROGRAM[3:])
    assert (state.program, state.override_percent, state.error) == ("KAMAL.MB4", 50.0, 0)
    assert codec.parse_state(STATE_ALARM[3:]).error == 4220


def test_state_with_eight_or_nine_semicolons_and_a_task_program() -> None:
    """Section 1.10: captures show nine, the format line another number; a name may stand between them."""
    head, tail = ";0;100;0;60000;0;1", "REP;START;1;0"
    for middle in (";" * 8, ";" * 9, ";" * 8 + "TASK.MB5;"):
        assert codec.parse_state(head + middle + tail).running


@pytest.mark.parametrize(
    "payload",
    [
        "",
        "60000",
        ";0;100;0;6000;0;1;;;;;;;;;REP;START;1;0",
        ";0;x;0;60000;0;1;;;;;;;;;REP;START;1;0",
        OPEN_RV1A,
    ],
)
def test_state_of_another_layout(payload: str) -> None:
    with pytest.raises(ProtocolError):
        codec.parse_state(payload)


def test_positions() -> None:
    """Section 1.11, captures."""
    assert codec.parse_positions(JPOS_6[3:]) == {
        "J1": -16.28,
        "J2": 38.72,
        "J3": 102.51,
        "J4": 16.73,
        "J5": 6.06,
        "J6": -19.16,
    }
    assert len(codec.parse_positions(JPOS_8[3:])) == 8
    assert list(codec.parse_positions(PPOS[3:])) == ["X", "Y", "Z", "A", "B", "C"]
    extra_axis = "X;1.00;Y;2.00;Z;3.00;C;179.93;L1;0.00;;6,0;100;0.00;00000000"
    assert codec.parse_positions(extra_axis)["L1"] == 0.0


def test_positions_of_four_axes_and_negative_zero() -> None:
    """Sections 1.11 and 7: the axis list of an RH is not known for sure; -0.00 occurs."""
    axes = codec.parse_positions("J1;-0.00;J2;90.00;J3;75.25;J4;-360.00;;****,****;20;0.00;00000000")
    assert axes == {"J1": 0.0, "J2": 90.0, "J3": 75.25, "J4": -360.0}


@pytest.mark.parametrize(
    "payload",
    [
        "",
        "J1;1.00;;****,****;75;0.00;00000000",
        "J1;1.00;J2;;;****,****;75;0.00;00000000",
        "J1;1.00;J1;2.00;;****,****;75;0.00;00000000",
        "J1;1.00;J2;nan;;****,****;75;0.00;00000000",
        "J1;1.00;J2;1e3;;****,****;75;0.00;00000000",
        "QoKJ1;1.00;J2;2.00;;****,****;75;0.00;00000000",
        ";".join(f"J{i};1.00" for i in range(9)) + ";;****,****;75;0.00;00000000",
        "100",
    ],
)
def test_positions_of_another_layout(payload: str) -> None:
    with pytest.raises(ProtocolError):
        codec.parse_positions(payload)


def test_error_number_and_level() -> None:
    """Section 1.13."""
    assert codec.parse_error("") == (0, 0)
    assert codec.parse_error("4140;2") == (4140, 2)
    with pytest.raises(ProtocolError, match="number;level"):
        codec.parse_error("4140;9")


def test_parameter_values() -> None:
    """Section 1.14: name;value;count; section 1.8 shows values separated by comma and space."""
    assert codec.parse_parameter("MEXTL;0.00, 0.00, 1.50;6", "MEXTL") == (0.0, 0.0, 1.5)
    assert codec.parse_parameter("MEJAR;-170.00,170.00;16", "MEJAR") == (-170.0, 170.0)
    for wrong in ("MEPAR;1.0;1", "MEJAR", "MEJAR;a,b;2"):
        with pytest.raises(ProtocolError):
            codec.parse_parameter(wrong, "MEJAR")


@pytest.mark.parametrize(
    ("layout", "first"),
    [
        (codec.bare, b"QoK"),
        (codec.bare, b"QeR561000000"),
        (codec.free_text, b"QoK100"),
        (codec.positions_text, b"QoKJ1;0.00;J2;0.00;;****,****;20;0.00;00000000"),
    ],
)
def test_an_answer_without_terminator_ends_where_another_begins(layout: codec.Layout, first: bytes) -> None:
    decoder = codec.AnswerDecoder(layout)
    answer = decoder.feed(first + b"QoK")
    assert answer == codec.parse_answer(first, terminated=False)
    assert decoder.rest == b"QoK"
