"""Texts of RAPID values and documents of resources, as the sheet has them."""

import json
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.drivers.abb.http import Answer
from catseye.drivers.abb.values import error_of, goal_text, number_of, states_of, value_of, whole_of
from catseye.drivers.roles.errors import ProtocolError


def answer(document: object) -> Answer:
    return Answer(200, (), json.dumps(document).encode())


STATE = {"_embedded": {"_state": [{"_type": "pnl-opmode", "_title": "opmode", "opmode": "AUTO"}]}}


def test_a_field_of_the_first_state_is_read() -> None:
    assert value_of(answer(STATE), "opmode") == "AUTO"
    with pytest.raises(ProtocolError, match="no speedratio"):
        value_of(answer(STATE), "speedratio")


def test_an_error_has_number_and_text() -> None:
    refused = answer({"_embedded": {"status": {"code": -1073445865, "msg": "no such thing"}}})
    assert error_of(refused) == (-1073445865, "no such thing")
    assert error_of(Answer(503, (), b"<html>")) == (503, "")


@pytest.mark.parametrize(
    ("text", "value"), [("9E+09", 9e9), ("-1.5E-05", -1.5e-5), (" 30 ", 30.0), (".5", 0.5)]
)
def test_numbers_are_read_as_rapid_writes_them(text: str, value: float) -> None:
    assert number_of(text) == value


@pytest.mark.parametrize("text", ["", "TRUE", "1,5", "1e999", "nan", None, 3])
def test_what_is_no_number_is_refused(text: object) -> None:
    with pytest.raises(ProtocolError):
        number_of(text)


def test_a_fraction_is_no_whole_number() -> None:
    with pytest.raises(ProtocolError, match="whole"):
        whole_of("1.5")


def test_a_goal_leaves_external_axes_alone() -> None:
    text = goal_text((1.0, -2.5, 0.0, 0.0, 30.0, 359.99999))
    robot, external = json.loads(text)
    assert robot == [1.0, -2.5, 0.0, 0.0, 30.0, 359.99999]
    assert external == [9e9] * 6


@given(st.lists(st.floats(-400.0, 400.0), min_size=6, max_size=6))
def test_goals_are_finer_than_a_num(joints: list[float]) -> None:
    written = json.loads(goal_text(tuple(joints)))[0]
    assert all(math.isclose(a, b, abs_tol=1e-7) for a, b in zip(written, joints, strict=True))


@given(st.one_of(st.binary(max_size=100), st.recursive(st.none() | st.text(), st.lists).map(json.dumps)))
def test_no_document_is_more_than_a_protocol_error(body: bytes | str) -> None:
    data = body.encode() if isinstance(body, str) else body
    with pytest.raises(ProtocolError):
        states_of(Answer(200, (), data))
    assert error_of(Answer(404, (), data)) == (404, "")
