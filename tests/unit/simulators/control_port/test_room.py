"""Requests of the control port about the room of a serial arm."""

from typing import Any

import numpy as np
import pytest

from catseye.simulators.config import EmulationConfig
from catseye.simulators.control_port.exchange import Answer, RefusedRequestError, Request
from catseye.simulators.control_port.faults import (
    BlockBeam,
    Bump,
    ClearFaults,
    DropTarget,
    LoosenTarget,
    ReadBack,
)
from catseye.simulators.control_port.messages import ClearBeam, ReadTruth
from catseye.simulators.control_port.operations import ControlSession
from catseye.simulators.control_port.survey_messages import (
    MountBallbar,
    PlaceTarget,
    ReadBallbar,
    ReadSurvey,
    SetUpScaleBar,
    TakeBallbarOff,
)
from catseye.simulators.emulated_bench import EmulatedBench, EmulatedSerialBench
from catseye.simulators.survey import Place
from tests.unit.simulators.benches import QUIET
from tests.unit.simulators.world.serial.arms import serial_arm
from tests.unit.simulators.world.serial.surveyed import EXACT, FORWARD

ARM = serial_arm("irb120")


class Stand:
    """A bench and a client of its control port."""

    def __init__(self) -> None:
        config = EmulationConfig(serial=ARM, start_joints=FORWARD, devices=(), survey=EXACT, seed=3)
        served = EmulatedSerialBench(config, ARM)
        self.bench, self._session = served.bench, ControlSession(served.reach)

    def ask(self, request: Request[Any]) -> Any:
        """Return the answer, as it comes over the wire."""
        self._session.feed(request.encode())
        return request.decode(self._session.answer() or b"")

    def near(self, name: str) -> Place:
        """Return where a nest is in the tracker's frame, from what the control port says."""
        state = self.ask(ReadSurvey())
        place = np.linalg.inv(np.array(state.tracker)) @ [*state.nests[name], 1.0]
        return float(place[0]), float(place[1]), float(place[2])


def test_the_survey_says_where_everything_is() -> None:
    stand = Stand()
    state = stand.ask(ReadSurvey())
    flange = np.array(state.flange)
    truth = {one["name"]: one["value"] for one in stand.ask(ReadTruth()).truth["parameters"]}
    nest = [truth[f"nest1.{part}"] for part in ("x_mm", "y_mm", "z_mm")]
    np.testing.assert_allclose((flange @ [*nest, 1.0])[:3], state.nests["nest1"], atol=1e-9)
    assert np.array(state.base)[0, 3] == pytest.approx(truth["base.x_mm"], abs=1e-9)
    assert (state.locked, state.empty, state.ballbar) == (None, [], None)
    assert stand.bench.tracker.aim(stand.near("nest1"))
    assert stand.ask(ReadSurvey()).locked == "nest1"


def test_a_fallen_target_is_put_back_by_hands() -> None:
    stand = Stand()
    stand.ask(DropTarget(target="nest2"))
    assert stand.ask(ReadSurvey()).empty == ["nest2"]
    stand.ask(PlaceTarget(target="nest2"))
    assert stand.ask(ReadSurvey()).empty == []


def test_a_loose_target_is_fastened_with_faults_cleared() -> None:
    stand = Stand()
    firm = stand.ask(ReadSurvey()).nests["nest1"]
    stand.ask(LoosenTarget(target="nest1", mm=1.0))
    assert np.linalg.norm(np.subtract(stand.ask(ReadSurvey()).nests["nest1"], firm)) > 0.1
    stand.ask(ClearFaults())
    np.testing.assert_allclose(stand.ask(ReadSurvey()).nests["nest1"], firm, atol=1e-9)


@pytest.mark.parametrize("instrument", ["tracker", "cmm"])
def test_a_bump_displaces_one_instrument(instrument: Any) -> None:
    stand = Stand()
    before = stand.ask(ReadSurvey())
    stand.ask(Bump(instrument=instrument, mm=3.0))
    after = stand.ask(ReadSurvey())
    moved = {
        name: float(np.linalg.norm((np.array(getattr(after, name)) - np.array(getattr(before, name)))[:3, 3]))
        for name in ("tracker", "cmm")
    }
    assert moved.pop(instrument) == pytest.approx(3.0, abs=1e-6)
    assert next(iter(moved.values())) == 0.0


def test_somebody_stands_before_the_tracker() -> None:
    stand = Stand()
    near = stand.near("nest1")
    stand.ask(BlockBeam())
    assert not stand.bench.tracker.aim(near)
    stand.ask(ClearBeam())
    assert stand.bench.tracker.aim(near)


def test_joints_read_back_are_off_by_hundredths() -> None:
    stand = Stand()
    exact = np.array(stand.bench.measured)
    stand.ask(ReadBack(deg=0.03))
    off = [np.array(stand.bench.measured) - exact]
    stand.bench.move_to((1.0, *FORWARD[1:]))
    stand.bench.advance(10.0)
    off.append(np.array(stand.bench.measured) - stand.bench.joints)
    assert 0.005 < np.sqrt((off[0] ** 2).mean()) < 0.08
    assert np.abs(off[1] - off[0]).max() > 0.005
    stand.ask(ClearFaults())
    np.testing.assert_allclose(stand.bench.measured, stand.bench.joints, atol=0.01)


def test_the_ballbar_is_mounted_read_and_taken_off() -> None:
    stand = Stand()
    x, y, z = stand.ask(ReadSurvey()).nests["nest1"]
    stand.ask(SetUpScaleBar(x_mm=700.0, y_mm=0.0, z_mm=300.0))
    mounted = stand.ask(MountBallbar(target="nest1", centre_mm=(x, y, z - 300.0)))
    state = stand.ask(ReadSurvey())
    true_mm = np.linalg.norm(np.subtract(state.nests["centre"], state.nests["nest1"])) - 300.0
    assert mounted.mounted == "nest1"
    assert mounted.deviation_mm == pytest.approx(true_mm, abs=1e-6)
    assert sorted(state.empty) == ["centre", "nest1"]
    stand.ask(TakeBallbarOff())
    reading = stand.ask(ReadBallbar())
    assert (reading.deviation_mm, reading.mounted) == (None, None)


@pytest.mark.parametrize("request_", [DropTarget(target="nest9"), PlaceTarget(target="nest9")])
def test_a_nest_that_is_not_there_is_refused(request_: Request[Answer]) -> None:
    with pytest.raises(RefusedRequestError, match="no nest 'nest9'; there are nest1"):
        Stand().ask(request_)


@pytest.mark.parametrize("request_", [ReadSurvey(), DropTarget(target="nest1")])
def test_a_scara_stands_in_no_such_room(request_: Request[Any]) -> None:
    session = ControlSession(EmulatedBench(QUIET).reach)
    session.feed(request_.encode())
    with pytest.raises(RefusedRequestError, match="no serial arm"):
        request_.decode(session.answer() or b"")
