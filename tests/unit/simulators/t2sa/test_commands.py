"""Lines of the emulated T2SA: cut out of any stream, parsed into verbs and arguments."""

from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st

from catseye.drivers.t2sa.codec import ReplyDecoder, encode
from catseye.simulators.t2sa.commands import LONGEST_BYTES, LineCutter, bad, good, parse

cuts = st.lists(st.integers(0, 400), max_size=8)
words = st.text(alphabet="abcXYZ019_. -", min_size=1, max_size=12).map(str.strip).filter(bool)


def fed(cutter: LineCutter, data: bytes, pieces: list[int]) -> list[str]:
    places = sorted({min(cut, len(data)) for cut in pieces} | {0, len(data)})
    return [line for start, end in pairwise(places) for line in cutter.feed(data[start:end])]


@given(st.lists(words, min_size=1, max_size=5), cuts)
def test_lines_are_found_however_they_are_cut(lines: list[str], pieces: list[int]) -> None:
    assert fed(LineCutter(), b"".join(map(encode, lines)), pieces) == lines


@given(st.binary(max_size=4000), cuts)
def test_any_bytes_are_lines_of_bounded_length(data: bytes, pieces: list[int]) -> None:
    for line in fed(LineCutter(), data, pieces):
        assert len(line) <= LONGEST_BYTES
        parse(line)


@given(words, st.lists(words, min_size=1, max_size=6))
def test_arguments_stand_between_semicolons(verb: str, arguments: list[str]) -> None:
    found = parse(f"!{verb}:{';'.join(arguments)}")
    assert (found.verb, found.arguments) == (f"!{verb}", arguments)


def test_a_pose_is_asked_for_with_a_blank() -> None:
    found = parse("?POS tool 1")
    assert (found.verb, found.arguments) == ("?POS", ["tool 1"])


@given(st.integers(100, 999), words)
def test_the_driver_reads_answers(code: int, text: str) -> None:
    for ok, said in ((True, good(text, code)), (False, bad(code, text))):
        reply = ReplyDecoder().feed(said)
        assert reply is not None
        assert (reply.ok, reply.code, reply.text) == (ok, code, text)
