"""The bench of the demonstration of motion resolution: a KUKA, and a counter that streams."""

from typing import Final

ARM: Final = "kr210-r2700"

_RATE_HZ: Final = 25.0
"""Of the stream, in bench time: a faster one would leave too little of each sample's time at high speeds."""

_CELL: Final = """\
# SIMULATION: the bench of the demonstration of motion resolution.
format = "catseye-cell/1"
name = "demo-kuka"

[robot]
driver = "kuka-varproxy"
endpoint = "tcp://127.0.0.1:7000"
arm = "{arm}"
override_cap_percent = 10

[robot.settings]
answer_timeout_s = 5.0
taken_timeout_s = 20.0

[robot.limits_deg]
a2 = [-130.0, -20.0]
a3 = [-110.0, 145.0]

[interferometer]
driver = "umd"
endpoint = "tcp://127.0.0.1:7001"

[interferometer.settings]
{setting}

[environment]
driver = "modbus-air"
endpoint = "tcp://127.0.0.1:10502"
map = "vaisala"
pressure_register = 44

[air]
formula = "ciddor"
co2_ppm = 450
vacuum_wavelength_nm = 632.9908

[tracker]
driver = "bench-tracker"
endpoint = "tcp://127.0.0.1:10099"

[angular_optics]
spacing_mm = 30.0

[linear_optics]
"""

# On a busy machine the emulators of a fast bench answer late; time-outs are in real seconds.
CELL: Final = _CELL.format(arm=ARM, setting="timeout_s = 10.0")


def emulator_cell(speed: float) -> str:
    """Return the text of the emulator's cell file: its display samples at a steady rate of bench time.

    Args:
        speed: bench seconds in one real second.
    """
    return _CELL.format(arm=ARM, setting=f"rate_hz = {_RATE_HZ * max(1.0, speed):g}")
