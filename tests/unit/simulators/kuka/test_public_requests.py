"""Requests of public clients that are not in a registry, byte by byte."""

from tests.transcripts import kuka_varproxy as transcript
from tests.unit.simulators.kuka.client import Client


def test_every_client_reads_the_answers() -> None:
    client = Client()
    for exchange in transcript.EXCHANGES:
        assert client.ask(exchange.request) == exchange.answer, exchange.source


def test_an_array_is_refused_shorter_than_a_value() -> None:
    reply = Client().ask(transcript.READ_ARRAY.request)
    assert int.from_bytes(reply[2:4]) == len(reply) - 4 < 5
    assert reply[-1] == 0


def test_a_search_over_tcp_is_refused() -> None:
    reply = Client().ask(transcript.SEARCH.request)
    assert reply[:2] == b"\x00\x04"
    assert reply[-1] == 0
