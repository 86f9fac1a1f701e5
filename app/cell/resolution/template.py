"""The cell file that `catseye init --system resolution` writes: a KUKA KR 210 with optics beside it."""

from typing import Final

TEMPLATE: Final = """\
# catseye cell: motion resolution and backlash of a KUKA KR 210 R2700, after the resolution paper.
# The way through a day: docs/guide-resolution.md. Check it with: catseye config validate FILE
format = "catseye-cell/1"
name = "lab-2"

[robot]
driver = "kuka-varproxy"                 # what it needs on the controller: docs/kuka.md
endpoint = "tcp://127.0.0.1:7000"        # of KUKAVARPROXY or C3 Bridge
arm = "kr210-r2700"                      # or the path of a description of your own
override_cap_percent = 10                # steps run at 1 % of the axis speed: 0.1 % at this override

# Narrower than the controller's own ranges where cables, fences or the building ask for it. Every position that is
# tested needs 5 deg of run-in and of range to either side.
#[robot.limits_deg]
#a2 = [-138.0, -8.0]

[interferometer]
driver = "lasertex-hpi"                  # any interferometer driver that gives at least 20 readings a second
endpoint = "tcp://127.0.0.1:10012"

[environment]
driver = "modbus-air"
endpoint = "tcp://127.0.0.1:10502"
map = "vaisala"
pressure_register = 44

# Angular optics, for joints: angle = arcsin(difference of the two paths / spacing).
[angular_optics]
spacing_mm = 30.0                        # between the two prisms of the retroreflector: from its certificate
u_spacing_mm = 0.03                      # standard uncertainty
distance_mm = 250.0                      # interferometer to retroreflector at most; as short as the robot allows
signal_min = 0.5                         # smallest signal, 0 ... 1, with which a recording begins

# Linear optics, for steps of the tool along the axes of the base.
[linear_optics]
distance_mm = 250.0                      # interferometer to retroreflector where a series begins: the dead path
signal_min = 0.5

# The emulated bench: its hands mount and align the optics. Leave it out on a real one.
[tracker]
driver = "bench-tracker"
endpoint = "tcp://127.0.0.1:10099"

# Dimensions of arm and surroundings are estimates until you have measured them; see docs/guide.md.
#[[workspace.keep_out]]
#name = "tripod"
#min_mm = [900.0, -1500.0, 0.0]
#max_mm = [1400.0, -1000.0, 1500.0]
"""
