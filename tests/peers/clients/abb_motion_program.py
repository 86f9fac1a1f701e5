"""Send a motion program with abb-motion-program-exec: `abb_motion_program.py URL`; prints how it goes.

The controller has no program of this client: what is tried is all that it asks of Robot Web Services before.
"""

import json
import sys

import abb_motion_program_exec as abb

client = abb.MotionProgramExecClient(base_url=sys.argv[1])
program = abb.MotionProgram()
program.MoveAbsJ(abb.jointtarget([5, 0, 0, 0, 30, 0], [0] * 6), abb.v100, abb.fine)
said: dict[str, object] = {}
try:
    client.execute_motion_program(program, wait=False)
except Exception as error:  # noqa: BLE001  # it has no other kind
    said["while_running"] = str(error)
client.abb_client.stop()
said["number"] = client.execute_motion_program(program, wait=False)
said["running"] = client.is_motion_program_running()
said["file"] = list(client.abb_client.list_files(client.abb_client.get_ramdisk_path()))
client.abb_client.stop()
client.wait_motion_program_complete()
said["complete"] = not client.is_motion_program_running()
print("\n" + json.dumps(said))  # noqa: T201  # data for the test
