"""The bench of the demonstration of six-axis calibration: an ABB IRB 120, a Leica tracker, a ballbar."""

from typing import Final

ARM: Final = "irb120"
TOOL_FILE: Final = "artifact.toml"

TOOL: Final = """\
# The triangular artifact of the six-axis paper, section 2.1: three nests, about as it describes them.
format = "catseye-tool/1"
name = "triangular artifact"
mass_kg = 2.7
centre_mm = [50.0, 25.0, 100.0]

[[target]]
name = "nest1"
x_mm = 0.0
y_mm = 0.0
z_mm = 125.0
normal = [0.0, 0.0, 1.0]

[[target]]
name = "nest2"
x_mm = 115.0
y_mm = 0.0
z_mm = 215.0
normal = [1.0, 0.0, 0.0]

[[target]]
name = "nest3"
x_mm = 0.0
y_mm = 150.0
z_mm = 125.0
normal = [0.0, 1.0, 0.0]
"""

_ROBOT: Final = f"""\
# SIMULATION: the bench of the demonstration of six-axis calibration.
format = "catseye-cell/1"
name = "demo-abb"

[robot]
driver = "abb-rws"
endpoint = "tcp://127.0.0.1:8080"
arm = "{ARM}"
tool = "{TOOL_FILE}"
override_cap_percent = 10

[robot.settings]
# On a busy machine the emulators of a fast bench answer late; time-outs are in real seconds.
answer_timeout_s = 5.0
taken_timeout_s = 20.0

[robot.limits_deg]                      # section 5 of the paper
j1 = [-90.0, 90.0]
j2 = [-5.0, 110.0]
j3 = [-85.0, 70.0]
j4 = [-150.0, 150.0]
j5 = [-90.0, 90.0]
j6 = [-180.0, 180.0]
"""

_ROOM: Final = """
# Where the arm's base stands before the tracker, roughly.
base_mm = [-2300.0, 300.0, -350.0]
base_deg = [0.0, 0.0, 0.0]

[[tracker.nest]]
name = "world1"
x_mm = -1950.0
y_mm = -50.0
z_mm = -330.0

[[tracker.nest]]
name = "world2"
x_mm = -1950.0
y_mm = 650.0
z_mm = -330.0

[[tracker.nest]]
name = "world3"
x_mm = -2650.0
y_mm = 650.0
z_mm = -330.0

[ballbar]
length_mm = 300.0
range_mm = 1.0
centre_mm = [450.0, 0.0, 200.0]
"""

CELL: Final = f"""{_ROBOT}
[tracker]
driver = "leica-emscon"
endpoint = "tcp://127.0.0.1:10700"
{_ROOM}"""
"""With the tracker."""

BAR_CELL: Final = f"""{_ROBOT}
[tracker]
driver = "bench-tracker"
endpoint = "tcp://127.0.0.1:10099"
{_ROOM}"""
"""The same bench while the ballbar is on it: hands mount it and read it."""
