"""The programs that are shipped, the driver and the emulated program speak of the same variables and constants."""

import re
from importlib.resources import files

from catseye.drivers.kuka import names
from catseye.drivers.kuka.names import Command, Result
from catseye.simulators.kuka import program
from catseye.simulators.kuka.values import value_text

_SHIPPED = files("catseye.drivers.kuka") / "programs"
DAT = (_SHIPPED / "CATSVARS.dat").read_text(encoding="ascii")
SRC = (_SHIPPED / "CATSKUKA.src").read_text(encoding="ascii")
CODE = "\n".join(line for line in SRC.splitlines() if not line.lstrip().startswith(";"))


def declared() -> dict[str, tuple[str, str]]:
    """Return type and initial value of each variable of the data list."""
    found = re.findall(r"^DECL GLOBAL (\w+) (\w+)=(.+)$", DAT, re.MULTILINE)
    return {name: (kind, value) for kind, name, value in found}


def routine(name: str) -> str:
    """Return the body of a subprogram."""
    found = re.search(rf"^DEF {name}\(.*?\)\n(.*?)^END$", CODE, re.MULTILINE | re.DOTALL)
    assert found is not None
    return found[1]


def test_the_emulated_program_has_the_variables_declared() -> None:
    kinds = {"BOOL": bool, "INT": int, "REAL": float}
    emulated = program.declarations()
    assert emulated.keys() == declared().keys()
    for name, (kind, value) in declared().items():
        if kind in kinds:
            assert type(emulated[name]) is kinds[kind]
            assert value_text(emulated[name]) == value


def test_the_driver_asks_for_variables_that_are_declared() -> None:
    own = {value for value in vars(names).values() if isinstance(value, str) and value.startswith("CATS_")}
    assert {*own, *names.LINE} == declared().keys()
    assert declared()[names.VERSION] == ("INT", str(names.PROGRAM_VERSION))


def test_the_program_uses_declared_variables_only() -> None:
    routines = set(re.findall(r"^DEF (\w+)\(", SRC, re.MULTILINE))
    used = set(re.findall(r"\bCATS_\w+", CODE))
    assert used - routines <= declared().keys()
    assert routines - {"CATSKUKA"} <= used


def test_commands_and_results_have_the_same_numbers() -> None:
    assert {c.name: c.value for c in Command} == {c.name: c.value for c in program.Order if c}
    assert {r.name: r.value for r in Result} == {r.name: r.value for r in program.Result}
    cases = dict(re.findall(r"CASE (\d)\s+(CATS_\w+)\(", routine("CATS_MOVE")))
    assert cases == {"1": "CATS_AXES", "2": "CATS_STEP", "3": "CATS_LINE", "4": "CATS_AXES"}
    assert f"CATS_CMD>{max(Command)}" in routine("CATS_TAKE")


def test_stop_and_heartbeat_brake_by_interrupt() -> None:
    main = routine("CATSKUKA")
    assert f"INTERRUPT DECL 11 WHEN CATS_STOP==TRUE DO CATS_HALT({Result.STOPPED})" in main
    assert f"INTERRUPT DECL 12 WHEN $TIMER_FLAG[20]==TRUE DO CATS_HALT({Result.NO_HEARTBEAT})" in main
    assert f"$TIMER[20]=-{1000 * program.HEARTBEAT_S:.0f}" in routine("CATS_HEAR")
    assert routine("CATS_HALT").split("\n")[1] == "BRAKE"
    assert "RESUME" in routine("CATS_HALT")


def test_every_interrupt_is_on_before_anything_moves() -> None:
    move = routine("CATS_MOVE")
    armed = [move.index(f"INTERRUPT ON {number}") for number in (11, 12, 13)]
    assert max(armed) < move.index("IF CATS_STOP==TRUE") < move.index("SWITCH CATS_CMD")


def test_a_sign_of_life_that_came_early_is_taken_back() -> None:
    # An interrupt sees a change only: one that came before it was on would hide all that follow.
    move = routine("CATS_MOVE")
    heard = [found.start() for found in re.finditer(r"CATS_HEAR\( \)", move)]
    assert move.index("INTERRUPT ON 13") < heard[-1] < move.index("SWITCH CATS_CMD")
    assert "CATS_BEAT=FALSE" in routine("CATS_HEAR")


def test_the_timer_is_set_before_its_interrupt_is_on() -> None:
    # What the timer of an earlier motion has left would brake this one.
    move = routine("CATS_MOVE")
    assert move.index("CATS_HEAR( )") < move.index("$TIMER_STOP[20]=FALSE") < move.index("INTERRUPT ON 12")


def test_steps_add_to_the_measured_place() -> None:
    step, line = routine("CATS_STEP"), routine("CATS_LINE")
    assert "MEASURED=$AXIS_ACT_MEAS" in step
    for number in range(1, 7):
        assert f"CASE {number}\n      GOAL.A{number}=MEASURED.A{number}+CATS_INC" in step
    assert "MEASURED=$POS_ACT_MEAS" in line
    assert all(f"GOAL.{axis}=MEASURED.{axis}+CATS_{axis}\n" in line for axis in "XYZ")


def test_a_straight_step_keeps_the_measured_orientation() -> None:
    assert all(f"GOAL.{angle}=MEASURED.{angle}\n" in routine("CATS_LINE") for angle in "ABC")


def test_steps_are_as_slow_as_the_emulated_ones() -> None:
    assert f"CATS_SPEED({program.STEP_PERCENT})" in routine("CATS_STEP")
    speeds = dict(re.findall(r"CASE (\d)\s+CATS_AXES\((\d+)\)", routine("CATS_MOVE")))
    assert speeds == {
        str(int(Command.AXES)): str(program.MOVE_PERCENT),
        str(int(Command.STEP_TO)): str(program.STEP_PERCENT),
    }
    assert "CATS_SPEED(PERCENT)\nPTP GOAL" in routine("CATS_AXES")
    assert f"$VEL.CP={program.LINE_M_S}" in routine("CATS_LINE")


def test_an_order_is_refused_for_the_same_reasons() -> None:
    examined = re.findall(r"RESULT=(\d)", routine("CATS_TAKE"))
    reasons = {Result.UNKNOWN, Result.TOO_LARGE, Result.NOT_PREPARED, Result.STOP_STANDS, Result.UNDER_WAY}
    assert {int(number) for number in examined} == set(reasons)


def test_a_step_to_a_pose_is_a_short_one() -> None:
    take = routine("CATS_TAKE")
    assert "HERE=$AXIS_ACT\n" in take
    for number in range(1, 7):
        assert f"(ABS(CATS_GOAL.A{number}-HERE.A{number})>CATS_MAX_DEG)" in take


def test_an_order_is_taken_before_it_is_examined() -> None:
    take = routine("CATS_TAKE")
    assert (
        take.index("CATS_RESULT=RESULT") < take.index("CATS_TAKEN=NUMBER") < take.index("IF CATS_FOR<>NUMBER")
    )


def test_external_axes_stay_where_they_are() -> None:
    assert not re.search(r"\.E\d\s*=", CODE)
    assert "GOAL=$AXIS_ACT\n" in routine("CATS_AXES")
