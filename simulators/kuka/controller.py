"""The KR C4 that all clients of the proxy share: its variables, its panel, the arm and the program that moves it."""

from functools import partial
from typing import Final

from catseye.simulators.config import SerialArm
from catseye.simulators.kuka.arm_control import MODES, ArmControl
from catseye.simulators.kuka.kinematics import Kinematics
from catseye.simulators.kuka.panel import Panel
from catseye.simulators.kuka.program import CatsKuka
from catseye.simulators.kuka.values import (
    Structure,
    Symbol,
    Value,
    ValueTextError,
    axis_inc,
    e6axis,
    e6pos,
    frame,
    load,
    single,
)
from catseye.simulators.kuka.variables import Variables
from catseye.simulators.world.serial.bench import SerialBench
from catseye.simulators.world.timekeeper import TimeKeeper

_SPEED_STEP_S = 0.012
_PROGRAM_STATES = frozenset({"P_FREE", "P_RESET", "P_ACTIVE", "P_STOP", "P_END"})
_MODES = frozenset(MODES)
_MODEL: Final = "#{name} EMULATOR C4 FLR"
_SERIAL: Final = 900_001


class KukaController:
    """What all clients of one controller share.

    Args:
        arm: as its maker describes it.
        keeper: bench time.

    Attributes:
        variables: that the proxy reads and writes.
        program: that moves the arm.
        panel: its smartPAD and mode switch.
    """

    def __init__(self, bench: SerialBench, arm: SerialArm, keeper: TimeKeeper) -> None:
        self.control = ArmControl(bench, arm, keeper.changed)
        self.program = CatsKuka(arm, self.control, keeper)
        self.panel = Panel(self.control, self.program)
        self.variables = Variables()
        self._bench = bench
        self._tool = self._base = frame()
        self._load = load()
        self._install(arm)

    @property
    def servo_on(self) -> bool:
        """The drives hold the arm."""
        return self.control.servo_on

    @property
    def alarm(self) -> int:
        """Number of the message that keeps the program from running, 0 for none."""
        return self.control.alarm

    def raise_alarm(self, number: int) -> None:
        """Let a message occur that stops the program."""
        self.control.raise_alarm(number)

    def set_emergency_stop(self, *, on: bool) -> None:
        """Open or close the emergency stop circuit."""
        self.control.set_emergency_stop(on=on)

    def set_teach_mode(self, *, on: bool) -> None:
        """Turn the mode switch to T1, or back to EX."""
        self.control.set_mode("T1" if on else "EX")

    def switch_servo_off(self) -> None:
        """Stop the arm and take the power off."""
        self.control.switch_servo_off()

    def lose_power(self) -> None:
        """Stop the arm and start cold: no program is selected; data lists and the mode switch stay as they are."""
        self.control.lose_power()
        self.program.deselect()
        self._tool = self._base = frame()
        self._load = load()

    def clear_faults(self) -> None:
        """Close the emergency stop circuit, turn the switch back, confirm, power the drives, start the program."""
        self.control.emergency_stop = False
        self.control.alarm = 0
        self.control.switch_servo_on()
        self.control.mode = "EX"
        if not self.program.running:
            self.program.reset()
            self.program.start()

    def press(self, key: str) -> None:
        """Press a key of the panel, or turn the mode switch; see `Panel`.

        Raises:
            EmulatorError: it has no effect now.
        """
        self.panel.press(key)

    def _install(self, arm: SerialArm) -> None:
        kinematics, bench, add = Kinematics(arm), self._bench, self.variables.add
        add("$AXIS_ACT", lambda: e6axis(bench.joints))
        add("$AXIS_ACT_MEAS", lambda: e6axis(bench.measured))
        add("$AXIS_INC", lambda: axis_inc(bench.encoder_counts))
        add("$POS_ACT", lambda: e6pos(kinematics.place(bench.joints), 2, 35))
        add("$POS_ACT_MEAS", lambda: e6pos(kinematics.place(bench.measured), 2, 35))
        add("$VEL_AXIS_ACT", lambda: [single(value) for value in self._speeds_percent(arm)])
        add("$TORQUE_AXIS_ACT", lambda: [single(torque) for torque in bench.torques_nm])
        add("$OV_PRO", lambda: self.control.override_percent, self._set_override)
        add("$MODE_OP", lambda: Symbol(self.control.mode, _MODES))
        add("$PRO_STATE", lambda: Symbol(self._program_state, _PROGRAM_STATES))
        add("$PERI_RDY", lambda: self.control.servo_on)
        add("$ALARM_STOP", lambda: not self.control.emergency_stop)
        add("$STOPMESS", lambda: bool(self.control.alarm) or self.control.emergency_stop)
        add("$TOOL", lambda: self._tool, partial(self._set_structure, "_tool"))
        add("$BASE", lambda: self._base, partial(self._set_structure, "_base"))
        add("$LOAD", lambda: self._load, partial(self._set_structure, "_load"))
        add("$MODEL_NAME", lambda: _MODEL.format(name=arm.name.replace(" ", "").upper()))
        add("$ROBTRAFO", lambda: _MODEL.format(name=arm.name.replace(" ", "").upper()))
        add("$KR_SERIALNO", lambda: _SERIAL)
        for name in self.program.variables:
            add(name, partial(self.program.variables.__getitem__, name), partial(self._set_own, name))

    @property
    def _program_state(self) -> str:
        if self.program.running:
            return "P_ACTIVE"
        if not self.program.selected:
            return "P_FREE"
        return "P_RESET" if self.program.at_first_line else "P_STOP"

    def _speeds_percent(self, arm: SerialArm) -> list[float]:
        """Return the speeds of the motors over the last cycle, from their encoders, per cent of the largest."""
        plant, now_s = self._bench.plant, self._bench.time_s
        before, after = (plant.measured(max(0.0, now_s - ago_s)) for ago_s in (_SPEED_STEP_S, 0.0))
        ways = zip(before, after, arm.joints, strict=True)
        return [100.0 * (b - a) / _SPEED_STEP_S / joint.speed for a, b, joint in ways]

    def _set_override(self, value: Value) -> None:
        if not isinstance(value, int) or not 0 <= value <= 100:
            raise ValueTextError
        self.control.set_override(value)

    def _set_structure(self, attribute: str, value: Value) -> None:
        if isinstance(value, Structure):
            setattr(self, attribute, value)

    def _set_own(self, name: str, value: Value) -> None:
        self.program.variables[name] = value
        self.program.written()
