"""What the sheet does not know of a controller (sections 1.7, 1.11, 5.1 and 7); choose what a client shall meet."""

from typing import Literal

from pydantic import Field

from catseye.simulators.emulator import DeviceOptions
from catseye.simulators.melfa import alarms


class Choices(DeviceOptions):
    """How this controller behaves where no source says.

    Attributes:
        exclusive_right: one connection only may hold the operation right; others are refused with 6020.
        teach_keeps_right: in TEACH the right stays; otherwise it is lost, and CNTLON is refused with 5000.
        stop_overtakes: a STOP behind a waiting EXEC2 on the same connection is heard; otherwise that connection is
            not read before EXEC2 has answered.
        reset_while_running: RSTPRG, SLOTINIT and RUN act on a program that waits for its PC; otherwise they are
            refused with 5640 as long as it runs.
        jog_mm_s: speed of the tool in a jog along axes of space at an override of 100 %.
        jog_percent: jog speed at an override of 100 %, per cent of the largest speed.
        inch_high: step of high inching, deg or mm.
        inch_low: step of low inching, deg or mm.
        pulses_per_unit: encoder pulses for one degree or millimetre.
        path_mm_s2: acceleration of straight and circular motions at ACCEL 100.
        base_places_world: BASE states the world's place in the arm's coordinates; otherwise the arm's place in the
            world.
        read_only_number: error number of a write to a status variable.
        limit_raises_alarm: a motion of direct execution out of range or reach leaves its alarm, so that nothing moves
            before RSTALRM; otherwise it is only refused.
        step_letters: letters of STEP for one line forward: the sheet has 1, a public client I.
        step_back: what one step back carries out: the last motion before the line, or the line before it.
        lists_breakpoints: BRKPTGET answers all breakpoints as VALS answers variables, `<program>;<line>;<kind>` each;
            otherwise it is refused with 6010: nobody gives its layout.
        lock_shows_commands: while the machine is locked, positions are those that motions command, as if the arm
            moved; otherwise those of the arm. Feedback is the arm's in any case.
        line_time_s: bench time that a program's line takes beside its motion.
    """

    exclusive_right: bool = False
    teach_keeps_right: bool = False
    stop_overtakes: bool = False
    reset_while_running: bool = False
    jog_mm_s: float = Field(default=250.0, gt=0.0)
    jog_percent: float = 10.0
    inch_high: float = 0.1
    inch_low: float = 0.01
    pulses_per_unit: float = 1000.0
    path_mm_s2: float = Field(default=5000.0, gt=0.0)
    base_places_world: bool = False
    read_only_number: int = Field(default=alarms.SYNTAX, ge=1, le=9999)
    limit_raises_alarm: bool = True
    step_letters: str = Field(default="1I", pattern="^(1|I|1I)$")
    step_back: Literal["motion", "line"] = "motion"
    lists_breakpoints: bool = False
    lock_shows_commands: bool = True
    line_time_s: float = 0.01
