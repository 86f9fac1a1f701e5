"""The stop ladder is one table, and every front end climbs it."""

import pytest

from catseye.app.protocol.ladder import Rung, ctrl_c_of_client, rung_of
from catseye.app.protocol.loss import Consequence, LossPolicy, after_loss
from catseye.app.protocol.state import ControlState as S

CTRL_C = [
    (S.IDLE, Rung.STOP),
    (S.STARTING, Rung.STOP),
    (S.EXECUTE, Rung.HOLD),
    (S.UNHOLDING, Rung.HOLD),
    (S.HOLDING, Rung.STOP),
    (S.HELD, Rung.STOP),
    (S.SUSPENDED, Rung.STOP),
    (S.SUSPENDING, Rung.STOP),
    (S.UNSUSPENDING, Rung.STOP),
    (S.CLEARING, Rung.STOP),
    (S.STOPPING, Rung.ABORT),
    (S.ABORTING, None),
    (S.STOPPED, None),
    (S.ABORTED, None),
    (S.COMPLETE, None),
]


def test_the_table_has_every_state() -> None:
    assert {state for state, _ in CTRL_C} == set(S)


@pytest.mark.parametrize(("state", "rung"), CTRL_C)
def test_ctrl_c_climbs_one_rung(state: S, rung: Rung | None) -> None:
    assert rung_of(state) == rung


@pytest.mark.parametrize(
    ("answers", "out_of_sight", "active", "way"),
    [
        (True, False, True, "ladder"),
        (True, False, False, "nothing"),
        (False, False, True, "stop-by-every-way"),
        (False, True, False, "stop-by-every-way"),
        (False, False, False, "nothing"),
    ],
)
def test_a_client_without_answers_stops_by_every_way(
    answers: bool, out_of_sight: bool, active: bool, way: str
) -> None:
    assert ctrl_c_of_client(answers=answers, out_of_sight=out_of_sight, active=active) == way


LOSSES: list[tuple[LossPolicy, S, Consequence]] = [
    ("continue", S.EXECUTE, "warn"),
    ("stop", S.STARTING, "stop"),
    ("hold", S.STARTING, "hold"),
    ("hold", S.EXECUTE, "hold"),
    ("hold", S.UNHOLDING, "hold"),
    ("hold", S.UNSUSPENDING, "hold"),
    ("hold", S.HELD, "nothing"),
    ("stop", S.STOPPING, "nothing"),
    ("continue", S.COMPLETE, "nothing"),
]


@pytest.mark.parametrize(("policy", "state", "consequence"), LOSSES)
def test_a_lost_front_end_means_what_the_cell_says(
    policy: LossPolicy, state: S, consequence: Consequence
) -> None:
    assert after_loss(policy, state) == consequence
