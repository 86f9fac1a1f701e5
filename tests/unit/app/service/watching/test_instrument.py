"""An instrument beside a serial arm as those who watch see it."""

from catseye.app.service.watching.instrument import instrument_of
from tests.unit.procedures.serial_arm.benches import CMM, NESTS, SIX
from tests.unit.procedures.six_axes import BENCH


def test_an_instrument_is_shown_with_nests_and_targets() -> None:
    found = instrument_of(SIX)
    assert found is not None
    assert found.measures == ("points",)
    assert found.nests == tuple(NESTS)
    assert found.targets == ("N1", "N2", "N3")
    assert (found.base_mm, found.base_deg) == ((-2300.0, 300.0, -350.0), (0.0, 0.0, 0.0))
    cmm = instrument_of(CMM)
    assert cmm is not None
    assert cmm.measures == ("poses",)


def test_an_arm_without_targets_has_no_instrument() -> None:
    assert instrument_of(BENCH) is None
