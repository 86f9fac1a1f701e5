"""rw/panel, rw/motionsystem, rw/system and rw/mastership."""

import numpy as np

from catseye.simulators.abb.calls import DOMAINS, Call
from catseye.simulators.abb.http import Answer
from catseye.simulators.abb.rapid import UNUSED, num_text
from catseye.simulators.abb.replies import NO_VALUE, NOT_FOUND, NOTHING, REFUSED, RefusedError, State
from catseye.simulators.config import Joints
from catseye.simulators.errors import EmulatorError
from catseye.simulators.world.types import Floats

_ROBOT = "ROB_1"
_EXTERNAL = "abcdef"


def control_state(call: Call) -> Answer:
    """Return what the controller is in."""
    state = call.controller.control.state
    return call.said(State("pnl-ctrlstate", "ctrlstate", {"ctrlstate": state}))


def set_control_state(call: Call) -> Answer:
    """Switch the motors."""
    control, wanted = call.controller.control, call.value("ctrl-state")
    if wanted not in {"motoron", "motoroff"}:
        raise RefusedError(400, NO_VALUE, f"{wanted} is no state to be set")
    if control.mode != "AUTO":
        raise RefusedError(403, REFUSED, "the controller is in manual mode")
    try:
        if wanted == "motoron":
            control.switch_servo_on()
        else:
            control.switch_servo_off()
    except EmulatorError as error:
        raise RefusedError(403, REFUSED, str(error)) from None
    return NOTHING


def operating_mode(call: Call) -> Answer:
    """Return where the mode switch stands."""
    return call.said(State("pnl-opmode", "opmode", {"opmode": call.controller.control.mode}))


def speed_ratio(call: Call) -> Answer:
    """Return the speed ratio, per cent."""
    ratio = call.controller.control.override_percent
    return call.said(State("pnl-speedratio", "speedratio", {"speedratio": str(ratio)}))


def set_speed_ratio(call: Call) -> Answer:
    """Set the speed ratio to a whole number of per cent."""
    text = call.value("speed-ratio")
    try:
        ratio = float(text)
    except ValueError:
        ratio = -1.0
    if not 0.0 <= ratio <= 100.0:
        raise RefusedError(400, NO_VALUE, f"{text} is no speed ratio")
    call.require_mode()
    call.controller.control.set_override(int(ratio))
    return NOTHING


def joint_target(call: Call) -> Answer:
    """Return the joints as they are measured, deg."""
    _require_robot(call)
    fields = {f"rax_{number}": num_text(angle) for number, angle in enumerate(_measured(call), 1)}
    fields |= {f"eax_{letter}": num_text(UNUSED) for letter in _EXTERNAL}
    return call.said(State("ms-jointtarget", "jointtarget", fields))


def robot_target(call: Call) -> Answer:
    """Return the place of tool0 in the base, mm, and its orientation as a quaternion."""
    _require_robot(call)
    query = call.request.query
    if query.get("tool", "tool0") != "tool0" or query.get("wobj", "wobj0") != "wobj0":
        raise RefusedError(404, NOT_FOUND, "this controller knows tool0 and wobj0")
    joints = _measured(call)
    frame = call.controller.screws.frames(np.array([joints]))[0, -1]
    fields = dict(zip("xyz", map(num_text, frame[:3, 3]), strict=True))
    turn = _quaternion(frame[:3, :3])
    fields |= {f"q{number}": num_text(part) for number, part in enumerate(turn, 1)}
    turns = [int(np.floor(joints[axis] / 90.0)) for axis in (0, 3, 5)]
    fields |= dict(zip(("cf1", "cf4", "cf6"), map(str, turns), strict=True)) | {"cfx": "0"}
    fields |= {f"eax{letter}": num_text(UNUSED) for letter in _EXTERNAL}
    return call.said(State("ms-robtargets", "robtarget", fields))


def system(call: Call) -> Answer:
    """Return what the system is called, and its version."""
    fields = {"name": call.controller.name, "rwversion": "6.13.0000", "sysid": "{EMULATOR}"}
    return call.said(State("sys-system-li", "system", fields))


def mastership(call: Call) -> Answer:
    """Request or release mastership, of all domains or of one."""
    action = call.request.query.get("action", "request")
    domains = call.parts or DOMAINS
    if action not in {"request", "release"} or not set(domains) <= set(DOMAINS):
        raise RefusedError(404, NOT_FOUND, "mastership is requested or released, of cfg, motion or rapid")
    for domain in domains:
        if action == "request":
            call.require_mode()
            call.masterships.request(domain, call.login)
        else:
            call.masterships.release(domain, call.login)
    return NOTHING


def _require_robot(call: Call) -> None:
    if call.parts != (_ROBOT,):
        raise RefusedError(404, NOT_FOUND, f"there is no mechanical unit {call.parts[0]}")


def _measured(call: Call) -> Joints:
    return call.controller.bench.measured


def _quaternion(turn: Floats) -> Floats:
    """Return q1...q4 of a rotation by the eigenvector of Bar-Itzhack's symmetric matrix; q1 is not negative."""
    a = turn
    k = np.array(
        [
            [a[0, 0] - a[1, 1] - a[2, 2], a[1, 0] + a[0, 1], a[2, 0] + a[0, 2], a[2, 1] - a[1, 2]],
            [a[1, 0] + a[0, 1], a[1, 1] - a[0, 0] - a[2, 2], a[2, 1] + a[1, 2], a[0, 2] - a[2, 0]],
            [a[2, 0] + a[0, 2], a[2, 1] + a[1, 2], a[2, 2] - a[0, 0] - a[1, 1], a[1, 0] - a[0, 1]],
            [a[2, 1] - a[1, 2], a[0, 2] - a[2, 0], a[1, 0] - a[0, 1], a[0, 0] + a[1, 1] + a[2, 2]],
        ]
    )
    x, y, z, w = np.linalg.eigh(k)[1][:, -1]
    found: Floats = np.array([w, x, y, z]) * (1.0 if w >= 0.0 else -1.0)
    return found
