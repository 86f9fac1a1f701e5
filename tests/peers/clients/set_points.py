"""Lead the arm with the public package melfapy: `set_points.py HOST PORT DX_MM DY_MM`; prints before and after."""

import json
import math
import sys
import time

from melfapy import Melfa

controller = Melfa.MelfaController(
    command=1,
    send_type=1,
    recv_type=1,
    pose=Melfa.MelfaPose([0] * 10),
    ex_pose=Melfa.MelfaPose([0] * 10),
    address=(sys.argv[1], int(sys.argv[2])),
    v_max=50,
    a_max=500,
    j_max=5000,
)
before = controller.get_position()
x, y, z, _, _, c, _, _, flag1, flag2 = before
target = [x + float(sys.argv[3]), y + float(sys.argv[4]), z, 0, 0, math.degrees(c), 0, 0, flag1, flag2]
controller.pose = Melfa.MelfaPose(target)
controller.state = list(before)
controller.send_packet()
time.sleep(0.3)
after = controller.get_position()
print("\n" + json.dumps([before, after]))  # noqa: T201  # data for the test
