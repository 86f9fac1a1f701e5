"""Numbers without end are refused at once: while the program reads one, nothing else goes on, a STOP included."""

from collections.abc import Callable

import pytest

from catseye.drivers.abb import values as abb
from catseye.drivers.abb.http import Answer
from catseye.drivers.kuka import values as kuka
from catseye.drivers.melfa import codec as melfa
from catseye.drivers.melfa import texts
from catseye.drivers.melfa.datalink import codec as datalink
from catseye.drivers.roles.errors import ProtocolError
from catseye.drivers.t2sa import codec as t2sa

DIGITS = 300_000
"""So many take milliseconds where each is looked at once, and minutes where it is for each of the others."""

READERS: dict[str, Callable[[str], object]] = {
    "abb": abb.number_of,
    "kuka": kuka.real_of,
    "melfa": lambda text: texts.parse_values(text, "SRVENC"),
    "melfa-datalink": lambda text: datalink.parse(b",".join([text.encode()] * 6)),
    "t2sa": lambda text: t2sa.parse_point(f"Single Point Measurement A result {text},1,1 True"),
}


@pytest.mark.timeout(60)
@pytest.mark.parametrize("read", READERS.values(), ids=READERS)
def test_a_number_without_end_is_refused_at_once(read: Callable[[str], object]) -> None:
    with pytest.raises(ProtocolError):
        read("9" * DIGITS + "x")


STATE = "QoK;0;100;0;0112{};0;1;;;;;;;;;REP;START;1;0\r"
DIRECTORY = "1.MB4;4767;24-02-2821:05:14;2;220160;12;;9;{};135256;6848;9661;14"
LOG = "04-02-09;17:54:32;{};text;L;1;1;detail"


@pytest.mark.parametrize(
    ("read", "text"),
    [
        (lambda text: melfa.parse_state(text), STATE[3:-1]),
        (texts.parse_directory, DIRECTORY),
        (texts.parse_log, LOG),
    ],
    ids=["state", "directory", "log"],
)
def test_whole_numbers_of_melfa_have_a_largest_length(read: Callable[[str], object], text: str) -> None:
    assert read(text.format("7"))
    with pytest.raises(ProtocolError):
        read(text.format("9" * 5000))


def test_an_answer_is_too_long_with_its_end_too() -> None:
    with pytest.raises(ProtocolError, match="within 4096 bytes"):
        melfa.AnswerDecoder(melfa.state_text).feed(STATE.format("9" * 5000).encode())


@pytest.mark.parametrize("code", ["1e999", "9" * 5000, '"' + "9" * 5000 + '"'])
def test_an_impossible_error_number_of_abb_is_left_out(code: str) -> None:
    body = '{"_embedded": {"status": {"code": ' + code + ', "msg": "no"}}}'
    assert abb.error_of(Answer(400, (), body.encode())) == (400, "")


@pytest.mark.parametrize("read", [kuka.real_of, abb.number_of], ids=["kuka", "abb"])
@pytest.mark.parametrize("text", ["\x1f7", "\x1c7\x1d"])
def test_a_separator_of_files_before_a_number_is_a_blank(read: Callable[[str], object], text: str) -> None:
    assert read(text) == 7.0
