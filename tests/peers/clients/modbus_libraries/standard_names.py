"""Calls of libraries that name their functions as the Modbus standard does."""

from collections.abc import Callable
from typing import Any

Calls = dict[str, Any]


def by_standard_names(call: Callable[[str], Any]) -> Calls:
    """Return the calls, each from the name of its function."""
    return {
        "holding": call("read_holding_registers"),
        "input": call("read_input_registers"),
        "coils": call("read_coils"),
        "discrete": call("read_discrete_inputs"),
        "write_register": call("write_single_register"),
        "write_registers": call("write_multiple_registers"),
        "write_coil": call("write_single_coil"),
        "write_coils": call("write_multiple_coils"),
    }
