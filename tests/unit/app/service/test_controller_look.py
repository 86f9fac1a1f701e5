"""What doctor says about a controller, from answers in the sheet's layouts."""

from catseye.app.service.controller_look import look_at_controller
from tests.unit.app.engine.fakes import LIMITS
from tests.unit.drivers.test_melfa_controller import asked

# Section 1.12 and 1.13 of the sheet `melfa`; MEJAR lists lower and upper limits in turn.
QUIET: dict[str, str | list[str]] = {
    "VALJ_FBC": "QoKJ_FBC=(+10.00,-20.00,+1.50,+30.25)",
    "STPSIG": "QoK0;0",
    "PNRMEJAR": "QoKMEJAR;-170.00, 170.00, -145.00, 145.00, 0.00, 150.00, -360.00, 360.00;8",
    "ERRORLOGTOP": "QoK24-02-28;21:05:14;2602;Target outside;L;;0;260200000",
    "ERRORLOGEND": "QoK24-02-28;21:05:14;2602;Target outside;L;;0;260200000",
}


async def test_a_controller_in_order_needs_nothing() -> None:
    async with asked(dict(QUIET)) as (_, controller):
        facts, advice = await look_at_controller(controller, LIMITS)
    assert facts == [
        "encoder feedback J1 10.00°, J2 -20.00°, J3 1.50 mm, J4 30.25°",
        "stop signals: none",
        "controller's limits (MEJAR): J1 -170…170, J2 -145…145, J3 0…150, J4 -360…360",
        "error log, last: 2024-02-28 21:05:14 L2602 Target outside",
    ]
    assert advice == []


async def test_sources_of_a_stop_and_limits_beyond_the_controller_call_for_something() -> None:
    narrow = QUIET | {
        "STPSIG": "QoKC;1",
        "PNRMEJAR": "QoKMEJAR;-120.00, 170.00, -145.00, 145.00, 0.00, 150.00, -360.00, 360.00;8",
    }
    async with asked(dict(narrow)) as (_, controller):
        facts, advice = await look_at_controller(controller, LIMITS)
    assert "stop signals: I/O signal, operating panel" in facts
    assert "emergency stop by: I/O signal" in facts
    assert len(advice) == 2
    assert "limits_deg.j1 = [-170, 170]" in advice[1]
    assert "-120…170" in advice[1]


async def test_a_controller_that_does_not_answer_a_question_can_be_used() -> None:
    async with asked(QUIET | {"STPSIG": "QeR601000000", "ERRORLOGTOP": "QoK", "ERRORLOGEND": "QoK"}) as (
        _,
        controller,
    ):
        facts, advice = await look_at_controller(controller, LIMITS)
    assert "not told by this controller" in facts[1]
    assert facts[3] == "error log: empty"
    assert advice == []
