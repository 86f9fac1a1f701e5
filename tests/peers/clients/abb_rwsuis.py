"""Lead an ABB with rwsuis: `abb_rwsuis.py URL`; prints what came."""

import json
import sys

from rwsuis import RWS

robot = RWS.RWS(sys.argv[1])
said = {
    "panel": [robot.get_controller_state(), robot.get_operation_mode()],
    "running": robot.is_running(),
    "goal": robot.get_rapid_variable("cats_goal"),
}
robot.set_rapid_variable("cats_speed", "25")
robot.set_speed_ratio(30)
robot.stop_RAPID()
said["stopped"] = robot.get_execution_state()
robot.motors_off()
said["off"] = robot.get_controller_state()
robot.motors_on()
robot.request_mastership()
robot.release_mastership()
robot.start_RAPID()
said["started"] = robot.get_execution_state()
print("\n" + json.dumps(said))  # noqa: T201  # data for the test
