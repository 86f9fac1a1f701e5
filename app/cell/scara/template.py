"""The cell file that `catseye init` writes: the paper's robot, reflectors and commands."""

from collections.abc import Mapping
from typing import Any, Final

from catseye.app.cell.unattended_template import UNATTENDED

_HEAD = """\
# catseye cell file: what stands on the bench. Every key carries its unit; unknown keys are refused.
# Check it with:   catseye config validate FILE
# See all values:  catseye config show FILE
format = "catseye-cell/1"
name = "lab-1"                          # you type this name to arm real hardware: catseye run ... --arm lab-1

[robot]
driver = "melfa-r3"
# The loopback address is for the emulators: catseye emulate FILE. A real controller's factory address is
# 192.168.0.20, its first TCP port 10001:
#   endpoint = "tcp://192.168.0.20:10001"
endpoint = "tcp://127.0.0.1:10001"
expected_model = "RH-3FRH5515"          # the controller has to report this model, or the links below are wrong
link1_mm = 325.0                        # nominal, from the catalogue
link2_mm = 225.0
j3_mm = 50.0                            # where J3 stands while measuring: the beam is then level with the reflectors
j3_range_mm = [40.0, 60.0]              # heights of J3 that the levelling of the beam may use
override_cap_percent = 20               # the program never drives faster
# override_cap_reason = ""              # reason for a cap above 30 %
drives_off_after_s = 300                # s of rest until the drives go off; for runs started in the terminal UI

[robot.limits_deg]                      # within the arm's and the controller's own; narrower for the cables
j1 = [-170.0, 170.0]
j2 = [-145.0, 145.0]
j4 = [-360.0, 360.0]

[interferometer]
driver = "line-counter"
# "default" is the dialect of the emulator. For a DISTAX L-IM-300A use "distax", whose protocol is not published:
# copy the profile, complete it with the manual and give its path here.
profile = "default"
endpoint = "tcp://127.0.0.1:10002"

[environment]
driver = "modbus-air"
endpoint = "tcp://127.0.0.1:10502"
map = "vaisala"
# The data sheets do not state the register of a PTU300's pressure. 44 (0x2C) is that of the emulator and of a DPT145:
# confirm it with your sensor's manual.
pressure_register = 44

# If the interferometer does not correct for the air itself (its profile or settings say so), the program does, with
# the dead path; without temperature, pressure and humidity nothing is measured then.
[air]
formula = "ciddor"                      # or "edlen", the modified equation of the NIST
co2_ppm = 450
vacuum_wavelength_nm = 632.9908         # any helium-neon laser; better the value of its certificate, here and below

[tracker]                               # only the emulated bench has one; leave this out for real hardware
driver = "bench-tracker"
endpoint = "tcp://127.0.0.1:10099"

[optics]
acceptance_mm = 1.0                     # the cat's eye returns a beam that misses its centre by less than this
max_miss_mm = 0.2                       # the plan splits its moves so that the beam stays this close
field_half_angle_deg = 80.0
column_radius_mm = 110.0                # the robot's base hides the reflector behind it
column_margin_mm = 5.0
theta40_deg = 0.0                       # beam direction at J4 = 0, roughly; the search finds it
signal_min = 0.1                        # weaker returns are not used; 0 for counters without a level
one_reflector = false                   # true: a single cat's eye, which you are asked to move from nest to nest

[alignment]                             # the screws of the interferometer's mount, for beam-level and beam-to-j4
stage_mm_per_turn = 0.5                 # lateral stage
stage_clockwise = "+y"                  # +y: to the left of the beam, seen from above
offset_tolerance_mm = 0.1
level_mrad_per_turn = 2.0               # vertical tilt
level_clockwise = "up"
level_tolerance_mrad = 0.2

[conditions]                            # outside of these the run is suspended until they are back
temperature_c = [15.0, 25.0]
pressure_hpa = [800.0, 1100.0]
humidity_percent = [5.0, 90.0]

"""

_REFLECTORS = """
[[reflector]]                           # rough places; the search finds them
name = "P1"
x_mm = 650.0
y_mm = -400.0

[[reflector]]
name = "P2"
x_mm = 680.0
y_mm = 0.0

[[reflector]]
name = "P3"
x_mm = 640.0
y_mm = 380.0

# What the bodies of the arm keep clear of: the table, a stand under each reflector, boxes. Links, quill, column and
# interferometer head are those of the arm's description. All dimensions are ESTIMATES until you measure them and set
# confirmed = true; before a real arm moves, the program names each one that is not confirmed. The frame is that of
# the arm's base: z = 0 at its foot.
[workspace]
clearance_mm = 5.0                      # kept between any two bodies

[workspace.table]
z_mm = 0.0
confirmed = false

[workspace.stands]                      # reflectors with their stands, up to the flange
radius_mm = 15.0
confirmed = false

[workspace.flange]                      # its height at J3 = 0
z_mm = 200.0
confirmed = false

# [[workspace.keep_out]]                # no part of the arm may enter; [[workspace.keep_in]]: none may leave
# name = "cabinet"
# min_mm = [-700.0, 300.0, 0.0]
# max_mm = [-400.0, 700.0, 900.0]

# [[body]]                              # replaces the arm's body of that name (base column, link 1, link 2, quill,
# name = "interferometer head"          # interferometer head), or adds one: a capsule in the frame of its joint
# joint = "J4"                          # "base", or J1 … J4; x along the beam at theta40_deg = 0, z upwards
# from_mm = [-30.0, 0.0, -50.0]
# to_mm = [0.0, 0.0, -50.0]
# radius_mm = 30.0
# confirmed = true

[measurement]                           # nodes of the maps, visited upwards then downwards: 22 x 16 = 352 commands
theta1_deg = [-140.0, -120.0, -100.0, -80.0, -60.0, -40.0, -20.0, 0.0, 20.0, 40.0, 60.0]
theta2_deg = [0.0, 20.0, 40.0, 60.0, 80.0, 100.0, 120.0, 140.0]
settle_time_s = 0.5
dwell_time_s = 0.5
readings = 10                           # spread over the dwell time
take_up_deg = 1.0                       # overshoot at every reversal; larger than any backlash
spread_limit_um = 5.0                   # if the readings of a point scatter more, they are taken again

[plausibility]                          # largest differences: an arm beyond them is refused, with the likely mistake
deviation_mdeg = 1000.0                 # of a joint's angle from its command
link_mm = 2.0                           # of a link from its nominal length
place_mm = 100.0                        # of a reflector from its rough place

# The error budget: Table 2 of the SCARA paper (k = 1) with the laser of [air]. correlation says which
# distances share one error: none (reading), those of a pose, of one angle of an axis, of neighbouring times, of a
# segment, or all of them (common). A shared error does not average out. Errors of the arm itself (position, radial,
# between-nodes, links) count in predictions as well.
# kind: length, position, radial, reflector (per segment: may have moved between them): value_um; scale, links:
# value_ppm; angle of j1 or j2, between-nodes: value_mdeg; direction: value_mrad.
# value: standard uncertainty (distribution = "normal") or half width ("uniform", "triangular", "arcsine").
[[uncertainty.contributor]]
name = "wavelength"                     # of any helium-neon laser; better that of its certificate (paper: 0.054)
kind = "scale"
value_ppm = 1.5
correlation = "common"

[[uncertainty.contributor]]
name = "wavelength correction"          # 0.19 µm in a distance of 743 mm
kind = "scale"
value_ppm = 0.256
correlation = "common"

[[uncertainty.contributor]]
name = "environmental change"
kind = "length"
value_um = 0.09

[[uncertainty.contributor]]
name = "repeatability of the robot"     # differs from arrival to arrival, in x and in y
kind = "position"
value_um = 10.0

[[uncertainty.contributor]]
name = "radial error motion of J1"      # depends on the angle of the axis, so it repeats
kind = "radial"
axis = "j1"
value_um = 5.0
correlation = "axis-angle"

[[uncertainty.contributor]]
name = "radial error motion of J2"
kind = "radial"
axis = "j2"
value_um = 5.0
correlation = "axis-angle"

[[uncertainty.contributor]]
name = "radial error motion of J4"
kind = "radial"
axis = "j4"
value_um = 10.0
correlation = "axis-angle"

[[uncertainty.contributor]]
name = "beam direction, J1"             # cosine error
kind = "direction"
value_mrad = 0.717

[[uncertainty.contributor]]
name = "beam direction, J2"
kind = "direction"
value_mrad = 0.717

[[uncertainty.contributor]]
name = "between the nodes of J1"        # rms of what the map cannot show, such as gear ripple: an assumption
kind = "between-nodes"
axis = "j1"
value_mdeg = 2.0
correlation = "axis-angle"

[[uncertainty.contributor]]
name = "between the nodes of J2"
kind = "between-nodes"
axis = "j2"
value_mdeg = 2.0
correlation = "axis-angle"

[[uncertainty.contributor]]
name = "drift of the zero"              # rms over the measurement: an assumption; the distances show how large it is
kind = "length"
value_um = 2.0
correlation = "time"
orders = 31                             # largest number of half periods in the measurement

[[uncertainty.contributor]]
name = "warmth of the links"            # both grow by the same fraction; rms about their mean: an assumption
kind = "links"
value_ppm = 2.0
correlation = "time"
orders = 3
"""

TEMPLATE: Final = _HEAD + UNATTENDED + _REFLECTORS


def is_meant(data: Mapping[str, Any]) -> bool:
    """Return whether the values of a cell file, right or wrong, state a SCARA's links or reflectors."""
    robot = data.get("robot")
    return "reflector" in data or (
        isinstance(robot, Mapping) and not {"link1_mm", "link2_mm"}.isdisjoint(robot)
    )
