"""Read a position display with ogameasure: `position_display.py LINE`; prints what came.

Of the identification, three lines, its call reads the first.
"""

import json
import sys

from pseudo_terminal import take_parity

take_parity()
from ogameasure.device.HEIDENHAIN.ND287 import ND287  # noqa: E402  # after its environment

display = ND287(sys.argv[1])


def lines(count: int) -> list[str]:
    """Return the lines that are left."""
    return [display.read().decode("latin-1") for _ in range(count)]


said = {
    "identification": [display.output_device_identification().decode("latin-1"), *lines(2)],
    "shown": display.output_position_display_value().decode("latin-1"),
    "position": display.output_current_position().decode("latin-1"),
    "error": display.output_error_message().decode("latin-1"),
    "software": display.output_software_ID_number().decode("latin-1"),
    "bar": display.output_status_bar().decode("latin-1"),
    "indicators": display.output_status_indicators().decode("latin-1"),
}
print("\n" + json.dumps(said))  # noqa: T201  # data for the test
