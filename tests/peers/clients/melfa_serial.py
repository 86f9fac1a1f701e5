"""Lead a six-axis MELFA with ctu-mitsubishi: `melfa_serial.py LINE`; prints the joints before and after, in degrees.

The class looks for a camera only when a picture is asked for; the camera's library is left out.
"""

import json
import sys
import time
from unittest.mock import MagicMock

import numpy as np
from pseudo_terminal import take_parity

sys.modules["pypylon"] = MagicMock()
take_parity()
from ctu_mitsubishi import Rv6s  # noqa: E402  # after its environment

robot = Rv6s(port=sys.argv[1])
robot.initialize()
before = np.rad2deg(robot.get_q())
target = np.deg2rad([10.0, 15.0, 20.0, -30.0, 0.0, 0.0])
robot.move_to_q(target)
end_s = time.monotonic() + 60.0
while np.abs(robot.get_q() - target)[:4].max() > 1e-3 and time.monotonic() < end_s:
    time.sleep(0.1)
after = np.rad2deg(robot.get_q())
robot.stop_robot()
robot.close_connection()
print("\n" + json.dumps([before.tolist(), after.tolist()]))  # noqa: T201  # data for the test
