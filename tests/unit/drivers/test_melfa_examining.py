"""What a controller says beyond its state, from answers in the sheet's layouts."""

from catseye.drivers.melfa.examining import examination_of
from tests.unit.drivers.test_melfa_controller import asked

# Section 1.12 and 1.13 of the sheet `melfa`.
QUIET: dict[str, str | list[str]] = {
    "VALJ_FBC": "QoKJ_FBC=(+10.00,-20.00,+1.50,+30.25)",
    "STPSIG": "QoK0;0",
    "ERRORLOGTOP": "QoK24-02-28;21:05:14;2602;Target outside;L;;0;260200000",
    "ERRORLOGEND": "QoK24-02-28;21:05:14;2602;Target outside;L;;0;260200000",
}


async def test_a_controller_in_order_needs_nothing() -> None:
    async with asked(dict(QUIET)) as (_, controller):
        found = await examination_of(controller)
    assert found.facts == (
        "encoder feedback J1 10.00°, J2 -20.00°, J3 1.50 mm, J4 30.25°",
        "stop signals: none",
        "error log, last: 2024-02-28 21:05:14 L2602 Target outside",
    )
    assert found.advice == ()


async def test_sources_of_a_stop_call_for_something() -> None:
    async with asked(QUIET | {"STPSIG": "QoKC;1"}) as (_, controller):
        found = await examination_of(controller)
    assert "stop signals: I/O signal, operating panel" in found.facts
    assert "emergency stop by: I/O signal" in found.facts
    assert len(found.advice) == 1


async def test_a_controller_not_answering_a_question_is_usable() -> None:
    async with asked(QUIET | {"STPSIG": "QeR601000000", "ERRORLOGTOP": "QoK", "ERRORLOGEND": "QoK"}) as (
        _,
        controller,
    ):
        found = await examination_of(controller)
    assert "not answered by this controller" in found.facts[1]
    assert found.facts[2] == "error log: empty"
    assert found.advice == ()
