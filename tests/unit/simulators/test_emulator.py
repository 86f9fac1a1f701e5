"""Emulators by name, as they register."""

import pytest

from catseye.app.testing.candidate import candidate_of
from catseye.simulators.config import EmulatedDevice
from catseye.simulators.emulated_bench import EmulatedBench
from catseye.simulators.emulator import emulator_names, load_emulator, sessions_of
from catseye.simulators.errors import EmulatorError
from tests.unit.simulators.benches import QUIET


@pytest.mark.parametrize("name", emulator_names())
def test_an_emulator_has_the_role_of_its_driver(name: str) -> None:
    assert load_emulator(name).role == candidate_of(name).role


def test_an_unknown_protocol_is_refused_with_those_that_exist() -> None:
    context = EmulatedBench(QUIET).context
    with pytest.raises(EmulatorError, match=r"gauge: there is no emulator of 'nonsense'; there are .*umd"):
        sessions_of(context, EmulatedDevice("gauge", "nonsense"), lambda _text: None)
