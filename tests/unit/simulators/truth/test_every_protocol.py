"""Whoever adds a protocol says how well its instrument knows what it answers, and shows it."""

from importlib import metadata

from catseye.simulators.emulator import GROUP
from tests.unit.simulators.truth import (
    test_air,
    test_lengths,
    test_melfa,
    test_rates,
    test_serial_arms,
    test_trackers,
)

KNOWS_ITS_CONTACT = {"modbus-io"}
"""A contact is open or closed; there is nothing to be unsure of."""


def test_every_protocol_is_shown_not_to_answer_the_truth() -> None:
    modules = (test_air, test_lengths, test_melfa, test_rates, test_serial_arms, test_trackers)
    shown = {protocol for module in modules for protocol in module.PROTOCOLS}
    ours = {entry.name for entry in metadata.entry_points(group=GROUP) if entry.value.startswith("catseye.")}
    assert shown | KNOWS_ITS_CONTACT == ours
