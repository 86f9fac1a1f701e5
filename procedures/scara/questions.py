"""What procedures of a SCARA ask."""

from dataclasses import replace
from typing import Final

from catseye.procedures.kit.beam.questions import BEAM_LOST, BEAM_NEEDED, UNSETTLED
from catseye.procedures.kit.questions import Question

PLACE: Final = Question(
    "place/<reflector>[/<number>]",
    "confirm",
    "the reflector is in its nest",
    "place/P1",
    motion=True,
)

SCREW_BEAM_LOST: Final = replace(BEAM_NEEDED, id="<screw>/beam/<number>", example="level/beam/1")

SCREW: Final = Question("<screw>/<number>", "confirm", "a screw is turned", "level/1", motion=True)

SCREW_SENSE: Final = Question(
    "<screw>-sense/<number>",
    "choice",
    "a screw acts the other way: its sense is reversed, or it was turned the wrong way",
    "level-sense/1",
    choices=("reversed", "turned the wrong way"),
    # Another wrong guess shows at the next measurement.
    safe_answer="reversed",
)

JOG: Final = Question(
    "jog/<reflector>/<number>/<number>",
    "text",
    "degrees by which J4 turns towards a reflector, or skip",
    "jog/P1/1/1",
    unit="deg",
    safe_answer="skip",
    motion=True,
)

MOUNT: Final = Question(
    "mount/<number>",
    "confirm",
    "the interferometer is mounted, turned by half a turn",
    "mount/1",
    motion=True,
)

POINT: Final = Question(
    "point/<pass>/<number>[/<number>]",
    "confirm",
    "the instrument has taken the point",
    "point/1/0001",
    motion=True,
)

MEASURED_FILE: Final = Question(
    "measured-file[/<number>]", "text", "path of the file that the tracker has written", "measured-file"
)

TARGET: Final = Question(
    "target/<point>",
    "choice",
    "the tracker has lost its target: the point is measured again, or the run ends",
    "target/point/1/0001",
    choices=("again", "stop"),
    safe_answer="stop",
    motion=True,
)

INDICATOR: Final = Question(
    "<mounting>/<way>/<cycle>/<side>/<number>/<direction>[/again]",
    "number",
    "what an indicator reads",
    "J1/bearing/1/upwards/001/x",
    unit="µm",
    motion=True,
)

INDICATOR_FILE: Final = Question(
    "<mounting>/<ways>/<cycle>/file/<direction>[/<attempt>]",
    "text",
    "path of the file with the readings of an indicator in a cycle",
    "J1/x/1/file/x",
    motion=True,
)

CENTRE: Final = Question(
    "<mounting>/centre/<number>[/<place>]",
    "number",
    "what indicator x reads, to see whether the artefact is centred",
    "J1/centre/1/0",
    unit="µm",
    motion=True,
)

TAP: Final = Question("<mounting>/tap/<number>", "confirm", "the artefact is tapped", "J1/tap/1", motion=True)

ARTEFACT: Final = Question(
    "<mounting>/<what>",
    "choice",
    "artefact and indicators are mounted, moved or off, as the text says",
    "J1/mount",
    choices=("done", "stop"),
    motion=True,
    rests_after=("stop",),
)

ROUNDS: Final = (PLACE, BEAM_NEEDED, UNSETTLED)
"""Of whatever comes back to a reflector again and again."""

TRACKED: Final = (PLACE, BEAM_LOST, UNSETTLED)
"""Of whatever follows a reflector."""

SCREWS: Final = (PLACE, SCREW, SCREW_SENSE, SCREW_BEAM_LOST, UNSETTLED)
"""Of whatever has the mount of the interferometer set."""

RADIAL: Final = (ARTEFACT, TAP, CENTRE, INDICATOR, INDICATOR_FILE)
