"""The cell file that `catseye init` writes: the paper's robot, reflectors and commands."""

from collections.abc import Mapping
from typing import Any, Final

from catseye.app.cell.unattended_template import UNATTENDED

_HEAD = """\
# catseye cell file: what stands on the bench. Every key carries its unit; unknown keys are refused.
# Check it with:   catseye config validate FILE
# See it resolved: catseye config show FILE
format = "catseye-cell/1"
name = "lab-1"                          # you type this name to arm real hardware: catseye run ... --arm lab-1

[robot]
driver = "melfa-r3"
# The loopback address is for the emulators: catseye emulate FILE. A real controller's factory address is
# 192.168.0.20, its first TCP port 10001:
#   endpoint = "tcp://192.168.0.20:10001"
endpoint = "tcp://127.0.0.1:10001"
expected_model = "RH-3FRH5515"          # the controller has to call itself so, or the links below are wrong
link1_mm = 325.0                        # nominal, from the catalogue
link2_mm = 225.0
j3_mm = 50.0                            # height at which everything is measured: the beam at the reflectors' height
j3_range_mm = [40.0, 60.0]              # heights that the levelling of the beam may drive J3 to
override_cap_percent = 20               # the program never drives faster
# override_cap_reason = ""              # why, for a cap above 30
drives_off_after_s = 300                # of rest after a run that was started in the terminal UI

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
# The sheets do not know the register of a PTU300's pressure. 44 (0x2C) is that of the emulator and of a DPT145:
# confirm it with your sensor's manual.
pressure_register = 44

# An interferometer that does not correct for the air by itself (its profile or settings say so) is corrected by the
# program, with the dead path; without temperature, pressure and humidity nothing is measured then.
[air]
formula = "ciddor"                      # or "edlen", the modified equation of the NIST
co2_ppm = 450
vacuum_wavelength_nm = 632.9908         # any helium-neon laser; better: its certificate, here and below

[tracker]                               # only the emulated bench has one; leave this out for real hardware
driver = "bench-tracker"
endpoint = "tcp://127.0.0.1:10099"

[optics]
acceptance_mm = 1.0                     # the cat's eye returns the beam up to this miss of its centre
max_miss_mm = 0.2                       # the plan splits its moves so that the beam stays this close
field_half_angle_deg = 80.0
column_radius_mm = 110.0                # the robot's base hides the reflector behind it
column_margin_mm = 5.0
theta40_deg = 0.0                       # beam direction at J4 = 0, roughly; the search finds it
signal_min = 0.1                        # weaker returns are not measured with; 0 for counters without a level
one_reflector = false                   # true: one cat's eye is carried from nest to nest; you are asked to

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
# interferometer head are those of the arm's description. All dimensions are ESTIMATES until you measure them and say
# confirmed = true; before a real arm moves every one that is not confirmed is named. The frame is that of the arm's
# base: z = 0 at its foot.
[workspace]
clearance_mm = 5.0                      # kept between any two bodies

[workspace.table]
z_mm = 0.0
confirmed = false

[workspace.stands]                      # reflectors with what carries them, up to the flange
radius_mm = 15.0
confirmed = false

[workspace.flange]                      # its height at J3 = 0
z_mm = 200.0
confirmed = false

# [[workspace.keep_out]]                # nothing of the arm may enter; [[workspace.keep_in]]: nothing may leave
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
spread_limit_um = 5.0                   # readings that scatter more have not settled and are taken again

[plausibility]                          # an identified arm beyond these is refused, with the likely mistake
deviation_mdeg = 1000.0                 # of a joint's angle from its command
link_mm = 2.0                           # of a link from its nominal length
place_mm = 100.0                        # of a reflector from its rough place

# The error budget: Table 2 of the SCARA paper (k = 1) with the laser of [air]. Each contributor says what shares its
# error: nothing (reading), a pose, the angle of an axis, neighbouring times, a segment, or the whole measurement
# (common). What is shared does not average out. What the arm does (position, radial, between-nodes, links) counts in
# predictions as well.
# kind: length, position, radial, reflector (per segment: may have moved between them): value_um; scale, links:
# value_ppm; angle of j1 or j2, between-nodes: value_mdeg; direction: value_mrad.
# value: standard uncertainty (distribution = "normal") or half width ("uniform", "triangular", "arcsine").
[[uncertainty.contributor]]
name = "wavelength"                     # any helium-neon laser's; else its certificate's, the paper's: 0.054
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
name = "radial error motion of J1"      # a function of the axis angle: it repeats
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
name = "between the nodes of J1"        # rms of what the map cannot hold, as the ripple of a gear: an assumption
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
orders = 31                             # half periods in the measurement, up to so many

[[uncertainty.contributor]]
name = "warmth of the links"            # both grow by one share; rms about their mean: an assumption
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
