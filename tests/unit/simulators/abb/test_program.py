"""The emulated CATSABB on bench time: what orders do, and what ends them."""

from collections.abc import Callable

import pytest

from catseye.simulators.abb.program import Result
from catseye.simulators.config import Joints
from catseye.simulators.emulated_bench import EmulatedAbbBench
from tests.unit.simulators.abb.benches import BENT, abb_bench

FAR: Joints = (60.0, *BENT[1:])


class Pc:
    """Writes data as a driver does, with signs of life or without."""

    def __init__(self, bench: EmulatedAbbBench) -> None:
        self.bench = bench
        self.data = bench.controller.program.data
        self.beats = 0

    def write(self, name: str, text: str) -> None:
        self.bench.controller.symbols.write(f"RAPID/T_ROB1/{name}", text)

    def order(self, number: int, goal: Joints, *, prepared: int | None = None) -> None:
        self.write("cats_goal", f"[[{','.join(map(str, goal))}],[9E9,9E9,9E9,9E9,9E9,9E9]]")
        self.write("cats_for", str(number if prepared is None else prepared))
        self.write("cats_seq", str(number))

    def beat_until(self, over: Callable[[], bool]) -> None:
        for _ in range(1000):
            if over():
                return
            self.beats += 1
            self.write("cats_beat", str(self.beats))
            self.bench.bench.advance(0.1)
        raise AssertionError("it does not end")

    def took_s(self, number: int, percent: int) -> float:
        """Return how long a motion by 30 degrees takes at a speed ratio."""
        self.bench.controller.control.set_override(percent)
        began_s = self.bench.bench.time_s
        self.order(number, (30.0 - self.j1_deg, *BENT[1:]))
        self.beat_until(lambda: self.done(number))
        return self.bench.bench.time_s - began_s

    def done(self, number: int) -> bool:
        return self.data["cats_done"] == float(number)

    def moving(self) -> bool:
        return self.bench.bench.moving

    @property
    def j1_deg(self) -> float:
        return self.bench.bench.joints[0]


@pytest.fixture
def pc() -> Pc:
    return Pc(abb_bench())


def test_an_order_moves_to_its_goal(pc: Pc) -> None:
    pc.order(1, FAR)
    pc.beat_until(lambda: pc.done(1))
    assert pc.data["cats_result"] == Result.DONE
    assert pc.bench.bench.joints == pytest.approx(FAR, abs=1e-5)


def test_an_order_that_is_not_prepared_moves_nothing(pc: Pc) -> None:
    pc.order(1, FAR, prepared=0)
    pc.beat_until(lambda: pc.done(1))
    assert (pc.data["cats_result"], pc.bench.bench.joints) == (Result.NOT_PREPARED, BENT)


def test_the_arm_stops_half_a_second_after_the_last_sign(pc: Pc) -> None:
    pc.bench.controller.control.set_override(5)
    pc.order(1, FAR)
    pc.beat_until(lambda: pc.j1_deg > 1.0)
    last_s = pc.bench.bench.time_s - 0.1
    pc.bench.bench.advance(2.0)
    braked = [e.time_s for e in pc.bench.journal.entries("robot") if e.text.startswith("stop towards")]
    assert 0.4 <= braked[0] - last_s <= 0.5
    assert (pc.data["cats_result"], pc.done(1), pc.moving()) == (Result.NO_HEARTBEAT, True, False)
    assert 1.0 < pc.j1_deg < 60.0


def test_the_speed_ratio_scales_a_motion(pc: Pc) -> None:
    assert pc.took_s(2, 5) / pc.took_s(1, 10) == pytest.approx(2.0, abs=0.2)


def test_a_stop_keeps_the_goal_until_the_pointer_is_reset(pc: Pc) -> None:
    controller = pc.bench.controller
    controller.control.set_override(5)
    pc.order(1, FAR)
    pc.beat_until(lambda: pc.j1_deg > 1.0)
    controller.press("stop")
    pc.bench.bench.advance(1.0)
    stood = pc.j1_deg
    assert not pc.moving()
    controller.press("start")
    pc.bench.bench.advance(0.2)
    assert pc.moving()
    controller.press("stop")
    controller.press("main")
    controller.press("start")
    pc.beat_until(lambda: not pc.moving())
    pc.bench.bench.advance(2.0)
    assert (pc.moving(), pc.done(1)) == (False, True)
    assert stood < pc.j1_deg < 60.0


def test_an_order_from_before_the_start_is_not_carried_out(pc: Pc) -> None:
    pc.bench.controller.press("stop")
    pc.order(1, FAR)
    pc.bench.controller.press("main")
    pc.bench.controller.press("start")
    pc.bench.bench.advance(2.0)
    assert (pc.done(1), pc.bench.bench.joints) == (True, BENT)


def test_a_goal_out_of_range_stops_the_program(pc: Pc) -> None:
    pc.order(1, (170.0, *BENT[1:]))
    pc.bench.bench.advance(1.0)
    controller = pc.bench.controller
    assert (controller.program.running, pc.bench.bench.joints, pc.done(1)) == (False, BENT, False)
    assert 50027 in [event.code for event in controller.events.newest_first()]


@pytest.mark.parametrize("key", ["guard", "MANR"])
def test_safeguard_and_mode_stop_arm_and_motors(pc: Pc, key: str) -> None:
    pc.bench.controller.control.set_override(5)
    pc.order(1, FAR)
    pc.beat_until(lambda: pc.j1_deg > 1.0)
    pc.bench.controller.press(key)
    pc.bench.bench.advance(1.0)
    assert (pc.moving(), pc.bench.controller.servo_on, pc.bench.controller.program.running) == (False,) * 3
    pc.bench.controller.clear_faults()
    assert (pc.bench.controller.servo_on, pc.bench.controller.program.running) == (True, True)
