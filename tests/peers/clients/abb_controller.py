"""Lead an ABB with abb_robot_client: `abb_controller.py URL`; prints what came.

Its asynchronous module rws_aio has a fault in its syntax and cannot be imported.
"""

import json
import sys
from typing import Any

import numpy as np
from abb_robot_client.rws import RWS, ABBException, JointTarget


def said_by(client: Any) -> dict[str, Any]:
    """Read, write, stop and start."""
    state = client.get_execution_state()
    joints = client.get_jointtarget().robax
    place = client.get_robtarget().trans
    tasks = client.get_tasks()
    said: dict[str, Any] = {
        "execution": [state.ctrlexecstate, state.cycle],
        "joints_deg": [float(value) for value in joints],
        "place_mm": [float(value) for value in place],
        "panel": [client.get_controller_state(), client.get_operation_mode()],
        "task": [tasks["T_ROB1"].excstate, tasks["T_ROB1"].motiontask],
        "log": client.read_event_log()[-1].seqnum,
    }
    client.set_speedratio(40)
    goal = JointTarget(np.array([0.1, 0.0, 0.0, 0.0, 0.5, 0.0]), np.zeros(6))
    client.set_rapid_variable_jointtarget("cats_goal", goal)
    back = client.get_rapid_variable_jointtarget("cats_goal")
    client.set_digital_io("do1", 1)
    client.upload_file("$HOME/peer.mod", b"MODULE peer")
    said |= {
        "speed": client.get_speedratio(),
        "goal_rad": [float(value) for value in back.robax],
        "digital": client.get_digital_io("do1"),
        "file": client.read_file("$HOME/peer.mod").decode(),
        "files": client.list_files("$HOME"),
    }
    client.delete_file("$HOME/peer.mod")
    client.stop()
    said["stopped"] = (client.get_execution_state()).ctrlexecstate
    client.resetpp()
    client.start(cycle="forever")
    said["started"] = list(client.get_execution_state())
    try:
        client.get_rapid_variable("nothing")
    except ABBException as error:
        said["refused"] = error.code
    return said


print("\n" + json.dumps(said_by(RWS(sys.argv[1]))))  # noqa: T201  # data for the test
