"""The cell file of an arm whose motion resolution is measured, as `catseye init --system resolution` writes it."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from catseye.app.cell.unattended_template import UNATTENDED

_HEAD = """\
# catseye cell file of an arm whose motion resolution is measured. The unit is part of every key.
# Check it with:   catseye config validate FILE
# See all values:  catseye config show FILE
format = "catseye-cell/1"
name = "arm-1"                          # you type this name to arm real hardware: catseye run ... --arm arm-1

"""

_KUKA = """\
[robot]
driver = "kuka-varproxy"
# The loopback address is for the emulators: catseye emulate FILE. On a real controller it is that of KUKAVARPROXY or
# C3 Bridge, port 7000; docs/kuka.md says what else runs there.
endpoint = "tcp://127.0.0.1:7000"
arm = "kr210-r2700"                     # or the path of a description of your own arm
override_cap_percent = 10               # the program never drives faster
# override_cap_reason = ""              # reason for a cap above 30 %
drives_off_after_s = 300                # s of rest until the drives go off; for runs started in the terminal UI

# [robot.limits_deg]                    # within the arm's own, which apply otherwise; narrower if cables need it
# a1 = [-170.0, 170.0]

"""

_MELFA = """\
[robot]
# The program CATSDL reports joints to 0.001 deg, the controller's resolution, at which a series ends. The R-protocol
# alone, "melfa-r3", reports them to 0.01 deg.
driver = "melfa-datalink"
# The loopback addresses are for the emulators: catseye emulate FILE. docs/controller.md says how a real controller is
# set up.
endpoint = "tcp://127.0.0.1:10001"
datalink_endpoint = "tcp://127.0.0.1:10003"
arm = "rh-3frh5515"                     # or the path of a description of your own arm
override_cap_percent = 10               # the program never drives faster
# override_cap_reason = ""              # reason for a cap above 30 %
drives_off_after_s = 300                # s of rest until the drives go off; for runs started in the terminal UI
# [robot.limits_deg]                    # a range for each joint, where cables need a narrower one than the arm's own

"""

_INSTRUMENTS = """\
[interferometer]
driver = "line-counter"
profile = "default"                     # the dialect of the emulator
endpoint = "tcp://127.0.0.1:10002"

[environment]
driver = "modbus-air"
endpoint = "tcp://127.0.0.1:10502"
map = "vaisala"
pressure_register = 44                  # of the emulator and of a DPT145: confirm it with your sensor's manual

[air]
formula = "ciddor"                      # or "edlen", the modified equation of the NIST
co2_ppm = 450
vacuum_wavelength_nm = 632.9908         # any helium-neon laser; better the value of its certificate

[tracker]                               # only the emulated bench has one; leave this out for real hardware
driver = "bench-tracker"
endpoint = "tcp://127.0.0.1:10099"

# Optics that are set up at each place of the arm; the run asks for them and checks their signal.
[angular_optics]
spacing_mm = 30.0                       # distance of the two prisms: see the angular retroreflector's certificate
u_spacing_mm = 0.01                     # its standard uncertainty
distance_mm = 250.0                     # from the interferometer to the retroreflector
signal_min = 0.5                        # weaker returns are not used
"""

_LINEAR = """
[linear_optics]                         # for resolution-cartesian
distance_mm = 250.0
signal_min = 0.5
"""

BY_ARM: Final[Mapping[str, str]] = MappingProxyType(
    {
        "kr210-r2700": _HEAD + _KUKA + _INSTRUMENTS + _LINEAR + "\n" + UNATTENDED,
        "rh-3frh5515": _HEAD + _MELFA + _INSTRUMENTS + "\n" + UNATTENDED,
    }
)
"""Texts by arm; the first is the one that is meant where none is named."""
