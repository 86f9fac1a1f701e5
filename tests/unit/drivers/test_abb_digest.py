"""Digest authentication against vectors of others, and masks against secrets."""

import re
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.drivers.abb.digest import Digest, Login, challenge_of
from catseye.drivers.abb.masking import masked, shown
from catseye.drivers.roles.device import Direction
from catseye.drivers.roles.errors import ProtocolError

RFC_2617 = (
    'Digest realm="testrealm@host.com", qop="auth,auth-int", nonce="dcd98b7102dd2f0e8b11d0f600bfb0c093", '
    'opaque="5ccc069c403ebaf9f0171e9517f40e41"'
)
"""Section 3.5 of RFC 2617, whose answer is printed there."""

CAPTURED = (
    'Digest realm="validusers@robapi.abb", domain="/", qop="auth", '
    'nonce="MGY0Yjc2MGY2Y2QyZjAwNzp2YWxpZHVzZXJzQHJvYmFwaS5hYmI6MTkwMjg5NjRlNGE6MA==", opaque="799d5", '
    'algorithm="MD5", stale="FALSE"'
)
"""Published capture of a real IRC5: its client said diddLOPR and was let in."""

SECRET_LINES = (
    b"Authorization: Digest response=1\r\nCookie: key=1\r\nset-cookie: key=2; path=/\r\nCOOKIE: x\r\n"
)
TRAFFIC = b"GET / HTTP/1.1\r\nHost: h\r\n" + SECRET_LINES + b'\r\n{"s": 1}\nset\r\n'


def test_the_example_of_the_standard_is_answered() -> None:
    digest = Digest(RFC_2617, Login("Mufasa", "Circle Of Life"), "0a4f113b")
    proof = digest.proof("GET", "/dir/index.html", ahead=1)
    assert 'response="6629fae49393a05397450978507c4ef1"' in proof
    assert 'qop=auth, nc=00000001, cnonce="0a4f113b"' in proof
    assert 'opaque="5ccc069c403ebaf9f0171e9517f40e41"' in proof


def test_a_real_controllers_challenge_is_answered() -> None:
    digest = Digest(CAPTURED, Login("Default User", "robotics"), "diddLOPR")
    assert 'response="c36e30cdd2961584cd41f6f49f6bcbba"' in digest.proof(
        "GET", "/rw/rapid/execution", ahead=1
    )


def test_a_challenge_of_old_is_answered_without_a_count() -> None:
    digest = Digest('Digest realm="r", nonce="n"', Login("u", "p"), "c")
    proof = digest.proof("GET", "/", ahead=1)
    # md5(md5("u:r:p") + ":n:" + md5("GET:/")) by openssl.
    assert 'response="f23121ca97143c6b358da620220c83b4"' in proof
    assert "nc=" not in proof


def test_what_the_standard_leaves_unquoted_is_unquoted() -> None:
    proof = Digest(CAPTURED, Login("u", "p"), "c").proof("GET", "/", ahead=1)
    # RFC 7616, section 3.4: algorithm, qop and nc.
    assert re.findall(r"(\w+)=([^\",\s]+)(?:,|$)", proof) == [
        ("algorithm", "MD5"),
        ("qop", "auth"),
        ("nc", "00000001"),
    ]


def test_proofs_ahead_use_nothing_up() -> None:
    digest = Digest(RFC_2617, Login("u", "p"), "c")
    counts = [re.findall(r"nc=(\w+)", digest.proof("GET", "/", ahead=ahead)) for ahead in (2, 1)]
    assert (counts, digest.count) == ([["00000002"], ["00000001"]], 0)


def test_quotes_in_a_challenge_are_kept() -> None:
    digest = Digest(r'Digest realm="a \"b\" c", nonce="n"', Login("u", "p"), "c")
    assert r'realm="a \"b\" c"' in digest.proof("GET", "/", ahead=1)


@pytest.mark.parametrize(
    "challenge",
    ['Digest realm="r", nonce="n", algorithm=SHA-256', 'Digest realm="r"', 'Digest nonce="n", qop="x"'],
)
def test_another_proof_is_refused(challenge: str) -> None:
    with pytest.raises(ProtocolError):
        Digest(challenge, Login("u", "p"), "c")


def test_the_digest_among_challenges_is_taken() -> None:
    assert challenge_of(['Basic realm="r"', RFC_2617]) == RFC_2617
    with pytest.raises(ProtocolError, match=r"2\.0"):
        challenge_of(['Basic realm="r"'])


@given(st.text(max_size=100))
def test_no_challenge_is_more_than_a_protocol_error(text: str) -> None:
    try:
        proof = Digest(f"Digest {text}", Login("u", "p"), "c").proof("GET", "/", ahead=1)
    except ProtocolError:
        return
    assert proof.startswith("Digest ")
    assert "\n" not in proof


@given(st.lists(st.integers(0, len(TRAFFIC)), max_size=12))
def test_secrets_are_masked_wherever_the_stream_is_cut(cuts: list[int]) -> None:
    said: list[bytes] = []
    sink = masked(lambda _direction, data: said.append(data))
    places = sorted({0, *cuts, len(TRAFFIC)})
    way: Direction = "rx"
    for start, end in pairwise(places):
        sink(way, TRAFFIC[start:end])
    assert b"".join(said) == (
        b"GET / HTTP/1.1\r\nHost: h\r\nAuthorization: ***\r\nCookie: ***\r\nset-cookie: ***\r\nCOOKIE: ***\r\n"
        b'\r\n{"s": 1}\nset\r\n'
    )


def test_texts_show_first_lines_only() -> None:
    assert shown(TRAFFIC) == "b'GET / HTTP/1.1'"
    assert shown(b"HTTP/1.1 200 OK\r\nSet-Cookie: key") == "b'HTTP/1.1 200 OK'"
    assert shown(b"key=1; path=/") == "13 bytes"
