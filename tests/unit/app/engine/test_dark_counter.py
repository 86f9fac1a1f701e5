"""A length counter that refuses: for want of a beam, which a procedure mends, or for another reason."""

from dataclasses import replace

import pytest

from catseye.app.engine.measuring import unless_dark
from catseye.drivers.roles.errors import RefusedError
from catseye.procedures.kit.errors import NoBeamError
from tests.unit.app.engine.fakes import FakeCounter, ManualClock


class Refusing(FakeCounter):
    """Refuses to zero."""

    async def zero(self) -> int:
        raise RefusedError("no zero: look at the display", 7)


def counter(*, returns: bool, lost: bool) -> Refusing:
    fake = Refusing(ManualClock())
    fake.beam = replace(fake.beam, beam_ok=returns, beam_lost=lost)
    return fake


@pytest.mark.parametrize(("returns", "lost"), [(False, True), (False, False), (True, True)])
async def test_a_refusal_with_a_broken_beam_is_a_beam_error(returns: bool, lost: bool) -> None:
    refusing = counter(returns=returns, lost=lost)
    with pytest.raises(NoBeamError, match="look at the display"):
        await unless_dark(refusing, refusing.zero())


async def test_a_refusal_with_an_unbroken_beam_is_passed_on() -> None:
    refusing = counter(returns=True, lost=False)
    with pytest.raises(RefusedError) as caught:
        await unless_dark(refusing, refusing.zero())
    assert caught.value.number == 7


async def test_an_answer_is_passed_on() -> None:
    fake = FakeCounter(ManualClock())
    assert await unless_dark(fake, fake.zero()) == 1
