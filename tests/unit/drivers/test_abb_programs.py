"""The module that is shipped, the driver and the emulated program speak of the same data and constants."""

import re
from importlib.resources import files

from catseye.drivers.abb import names
from catseye.simulators.abb import program
from catseye.simulators.abb.rapid import parsed, value_text

MODULE = (files("catseye.drivers.abb") / "programs" / "CATSABB.mod").read_text(encoding="ascii")
CODE = "\n".join(line.partition("!")[0].rstrip() for line in MODULE.splitlines())
TOOL = "cats_tool"


def declared() -> dict[str, tuple[str, str]]:
    """Return type and initial value of the persistent data."""
    return {name: (kind, text) for kind, name, text in re.findall(r"PERS (\w+) (\w+) := (.+);", CODE)}


def routine(name: str) -> str:
    """Return the body of a procedure or trap."""
    found = re.search(rf"(?:PROC|TRAP) {name}\b.*?\n(.*?)(?:ENDPROC|ENDTRAP)", CODE, re.DOTALL)
    assert found is not None
    return found[1]


def test_the_emulated_module_has_the_data_declared() -> None:
    emulated, shipped = program.declarations(), declared()
    shipped.pop(TOOL)
    assert emulated.keys() == shipped.keys()
    for name, (_, text) in shipped.items():
        assert value_text(parsed(text, emulated[name])) == value_text(emulated[name])


def test_the_driver_asks_for_data_that_are_declared() -> None:
    own = {value for value in vars(names).values() if isinstance(value, str) and value.startswith("cats_")}
    assert own == declared().keys() - {TOOL}
    assert declared()[names.VERSION] == ("num", str(names.MODULE_VERSION))
    assert re.search(rf"^MODULE {names.MODULE}$", CODE, re.MULTILINE)


def test_results_have_the_same_numbers() -> None:
    assert {r.name: r.value for r in names.Result} == {r.name: r.value for r in program.Result}
    written = {int(number) for number in re.findall(r"cats_result := (\d)", CODE.partition("PROC main")[2])}
    assert written == set(names.Result)


def test_an_order_is_taken_before_it_is_examined() -> None:
    take = routine("cats_take")
    assert (
        take.index("cats_result := 1")
        < take.index("cats_taken := number")
        < take.index("IF cats_for = number")
    )
    assert take.index("cats_move") < take.index("cats_done := number")


def test_an_order_from_before_the_start_is_not_carried_out() -> None:
    main = routine("main")
    assert (
        main.index("cats_taken := cats_seq") < main.index("cats_done := cats_seq") < main.index("WHILE TRUE")
    )


def test_the_heartbeat_is_watched_before_anything_moves() -> None:
    move = routine("cats_move")
    assert move.index("cats_heard := cats_beat") < move.index("ITimer") < move.index("MoveAbsJ")
    assert f"ITimer {program.TICK_S:g}, cats_tick" in move
    assert f"IF cats_missed >= {program.MOST_MISSED} THEN" in routine("cats_listen")


def test_silence_stops_the_arm_and_ends_the_order() -> None:
    listen = routine("cats_listen")
    steps = [listen.index(text) for text in ("StopMove", "ClearPath", "StartMove", "RAISE CATS_SILENT")]
    assert steps == sorted(steps)
    assert "ERROR (CATS_SILENT)\n    cats_result := 3;\n    RETURN;" in routine("cats_move")


def test_external_axes_stay_where_they_are() -> None:
    move = routine("cats_move")
    assert "goal := CJointT();\n    goal.robax := cats_goal.robax;" in move
    assert "MoveAbsJ goal, vmax, fine, cats_tool;" in move


def test_blocks_are_closed() -> None:
    for begin, end in (("PROC ", "ENDPROC"), ("TRAP ", "ENDTRAP"), ("WHILE ", "ENDWHILE"), ("IF ", "ENDIF")):
        begun = re.findall(rf"^\s*{begin}", CODE, re.MULTILINE)
        assert len(begun) == len(re.findall(rf"^\s*{end}\b", CODE, re.MULTILINE))
