"""What requests about the room of a serial arm do to the bench."""

import numpy as np

from catseye.simulators.control_port import faults
from catseye.simulators.control_port import survey_messages as messages
from catseye.simulators.control_port.exchange import Answer
from catseye.simulators.world.serial.bench import SerialBench
from catseye.simulators.world.types import Floats


def work_in_the_room(request: messages.SurveyRequest, bench: SerialBench) -> Answer:
    """Carry a request out.

    Raises:
        EmulatorError: the bench cannot do it in its present state.
    """
    match request:
        case messages.ReadSurvey():
            return _state(bench)
        case messages.SetUpScaleBar():
            bench.room.set_up_bar((request.x_mm, request.y_mm, request.z_mm), request.turn_deg)
        case messages.PlaceTarget():
            nest = bench.room.named(request.target)
            nest.occupied, nest.loose_mm = True, 0.0
        case messages.TakeBallbarOff():
            bench.ballbar.take_off()
        case messages.PlaceCup():
            bench.ballbar.place_cup(request.target)
        case messages.MountBallbar():
            bench.ballbar.mount(request.target, request.centre_mm)
            return _reading(bench)
        case messages.ReadBallbar():
            return _reading(bench)
        case messages.ReadBallbarRecording():
            times_s, deviations_mm = bench.ballbar.recording()
            return messages.BallbarRecording(
                t_s=np.round(times_s, 3).tolist(), deviation_mm=np.round(deviations_mm, 5).tolist()
            )
    return Answer()


def spoil_the_room(fault: faults.RoomFault, bench: SerialBench) -> None:
    """Let something go wrong.

    Raises:
        EmulatorError: there is no such nest.
    """
    match fault:
        case faults.DropTarget():
            bench.room.named(fault.target).occupied = False
        case faults.LoosenTarget():
            bench.room.named(fault.target).loose_mm = fault.mm
        case faults.Bump():
            station = (bench.tracker if fault.instrument == "tracker" else bench.cmm).station
            station.bump(fault.mm, fault.deg)
        case faults.ReadBack():
            bench.readback_deg = fault.deg


def _reading(bench: SerialBench) -> messages.BallbarReading:
    return messages.BallbarReading(deviation_mm=bench.ballbar.reading_mm(), mounted=bench.ballbar.mounted)


def _state(bench: SerialBench) -> messages.SurveyState:
    now, nests = np.array([bench.time_s]), bench.room.nests
    places = bench.room.places_mm(nests, now)[:, 0].tolist()
    return messages.SurveyState(
        base=_rows(bench.room.base_at(now)),
        flange=_rows(bench.room.frames_at(now)[:, -1]),
        nests=dict(zip(nests, map(tuple, places), strict=True)),
        empty=[name for name, nest in nests.items() if not nest.occupied],
        tracker=_rows(bench.tracker.station.frame_at(now)),
        locked=bench.tracker.target,
        cmm=_rows(bench.cmm.station.frame_at(now)),
        ballbar=bench.ballbar.mounted,
    )


def _rows(frames: Floats) -> messages.Frame:
    return tuple((a, b, c, d) for a, b, c, d in frames[0].tolist())
