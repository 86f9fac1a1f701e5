"""STATE and DSTATE (sheet, section 1.10).

The bit of cycle stop is set while one is asked for; WAIT while a program is paused, program select enabled while
none is, STOP signal from STOPON to STOPOFF.
"""

from catseye.simulators.melfa.commands.command import Client, Command
from catseye.simulators.melfa.controller import Controller

_REPEAT, _CYCLE_STOP, _LOCKED, _TEACH = 0x01, 0x02, 0x04, 0x08
_TEACH_RUN, _SERVO, _RUN, _RIGHT = 0x10, 0x20, 0x40, 0x80
_EMERGENCY, _STOP, _WAIT, _SIGNAL, _SELECT, _PSEUDO = 0x01, 0x02, 0x04, 0x08, 0x10, 0x40
_EDITING, _RUNNING = 1, 2


def _bits(controller: Controller, client: Client) -> str:
    task = controller.task
    run = (
        _REPEAT * task.repeat
        | _CYCLE_STOP * (task.running and task.cycle_stop)
        | _LOCKED * (controller.machine_lock is not None)
        | _TEACH * controller.teach_mode
    )
    run |= _TEACH_RUN * (controller.teach_mode and controller.executing)
    run |= _SERVO * controller.servo_on | _RUN * controller.executing
    run |= _RIGHT * (client in controller.right_holders)
    stop = _EMERGENCY * controller.emergency_stop | _STOP * controller.stopped | _WAIT * task.paused
    stop |= _SIGNAL * controller.stop_latched
    stop |= _SELECT * (not task.paused and not task.running) | _PSEUDO * controller.signals.pseudo
    return f"{run:02X}{stop:02X}{controller.alarm}"


def _state(controller: Controller, client: Client, arguments: str) -> str:
    del arguments
    task = controller.task
    edit = _RUNNING if task.running else _EDITING * bool(controller.editor.name)
    mode = "REP" if task.repeat else "CYC"
    start = f"{task.file_name};{task.line};{controller.override_percent};{edit}"
    return (
        f"{start};{_bits(controller, client)};{task.line};1;;;;;;;;;{mode};START;1;{_mechanism(controller)}"
    )


def _short_state(controller: Controller, client: Client, arguments: str) -> str:
    del arguments
    return f"{_bits(controller, client)};{controller.task.line};{_mechanism(controller)}"


def _mechanism(controller: Controller) -> int:
    return int(controller.executing)


COMMANDS = {"STATE": Command(_state), "DSTATE": Command(_short_state)}
