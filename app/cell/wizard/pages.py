"""The questions of the wizard, a page for each topic."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

from catseye.app.cell.model import CAP_WITHOUT_REASON_PERCENT
from catseye.app.cell.templates import RESOLUTION, SCARA, SIX_AXIS, TEMPLATES
from catseye.app.cell.wizard.drivers import drivers_of, further_endpoint_of, has_setting, setting_questions
from catseye.app.cell.wizard.question import YES_NO, Choice, Question
from catseye.app.cell.wizard.resolution import questions as resolution
from catseye.app.cell.wizard.scara.questions import REFLECTORS, joint_limits, measurement, nominal_arm, optics
from catseye.app.cell.wizard.six_axis import questions as six_axis

Answer = Callable[[str], str]
"""Returns the present answer to a key; what is asked can depend on it."""

_ENDPOINT: Final = "tcp://192.168.0.20:10001 or serial:///dev/ttyUSB0?baud=9600&parity=E&stopbits=2"

_TRACKERS: Final = (
    "leica-emscon leads a Leica; t2sa leads SpatialAnalyzer; file takes rows of another program or a person; "
    "bench-tracker is emulated: docs/trackers.md"
)


@dataclass(frozen=True)
class Page:
    """One topic.

    Attributes:
        name: of the page.
        title: in the list of pages.
        intro: one line above the questions.
        questions: depend on earlier answers.
        device: of the cell file that can be tested on this page; empty for none.
        system: that it is asked for; empty for every one.
        without: system that it is not asked for.
    """

    name: str
    title: str
    intro: str
    questions: Callable[[Answer], Sequence[Question]]
    device: str = ""
    system: str = ""
    without: str = ""


def _file(_answer: Answer) -> list[Question]:
    return [
        Question("file", "File", "where the cell file is written; an existing one is never lost unasked"),
        Question(
            "name",
            "Name of the cell",
            "you type this name to arm real hardware: letters, digits, _ . + -, at most 40",
        ),
        Question(
            SYSTEM,
            "System",
            "what you want to measure; a change starts the questions after this page again",
            "choice",
            tuple(Choice(name, template.title) for name, template in TEMPLATES.items()),
        ),
    ]


def _needs_reason(cap_percent: str) -> bool:
    try:
        return float(cap_percent) > CAP_WITHOUT_REASON_PERCENT
    except ValueError:
        return False


def _robot(answer: Answer) -> list[Question]:
    return [*_controller(answer), *nominal_arm(), *_override_cap(answer), *joint_limits()]


def _any_robot(answer: Answer) -> list[Question]:
    return [
        Question("robot.driver", "Driver", "which controller moves the arm", "choice", drivers_of("robot")),
        Question(
            "robot.endpoint",
            "Endpoint",
            "of the service on the controller: tcp://192.168.1.2:7000 for KUKAVARPROXY and C3 Bridge, "
            "tcp://192.168.125.1:80 for an ABB IRC5",
            find_out="the controller's address and the port of the service; see docs/kuka.md, docs/abb.md",
        ),
        *_override_cap(answer),
        *resolution.arm(answer),
    ]


def _arm_with_targets(answer: Answer) -> list[Question]:
    return [*_any_robot(answer), six_axis.tool()]


def _controller(answer: Answer) -> list[Question]:
    further = further_endpoint_of(answer("robot.driver"))
    following = Question(
        f"robot.{further}",
        "Endpoint of following",
        "where the program on the controller answers; udp:// for CATSMXT",
        find_out="the address that the program on the controller listens at; see docs/controller.md",
    )
    return [
        Question(
            "robot.driver",
            "Driver",
            "how the arm follows a reflector",
            "choice",
            drivers_of("robot"),
        ),
        Question(
            "robot.endpoint",
            "Endpoint",
            f"of the R-protocol: {_ENDPOINT}; the factory address of a CR controller is 192.168.0.20:10001",
            find_out="the controller's address: parameters NETIP and NETPORT, or the port of its serial line",
        ),
        *([following] if further else []),
        Question(
            "robot.expected_model",
            "Model",
            "name that the controller reports; the links belong to this model",
        ),
    ]


def _override_cap(answer: Answer) -> list[Question]:
    reason = Question("robot.override_cap_reason", "Reason for that", "why the arm is let go so fast")
    return [
        Question(
            "robot.override_cap_percent",
            "Override at most, %",
            "the program never drives faster; begin with 5 … 20",
            "number",
        ),
        *([reason] if _needs_reason(answer("robot.override_cap_percent")) else []),
    ]


def _interferometer(answer: Answer) -> list[Question]:
    profile = Question(
        "interferometer.profile",
        "Profile",
        "default or vacuum (the emulator's dialects), distax, or the path of a profile of your own (TOML)",
        find_out="which commands the counter understands: its manual, and catseye terminal",
        default="default",
    )
    driver = answer("interferometer.driver")
    return [
        Question(
            "interferometer.driver",
            "Driver",
            "which instrument counts the length",
            "choice",
            drivers_of("interferometer"),
        ),
        *([profile] if has_setting(driver, "profile") else []),
        Question(
            "interferometer.endpoint",
            "Endpoint",
            f"{_ENDPOINT}",
            find_out="the port and its baud rate, parity and stop bits: the instrument's manual or its front panel",
        ),
        *setting_questions("interferometer", driver, frozenset({"profile"})),
        Question(
            "air.vacuum_wavelength_nm",
            "Wavelength, nm",
            "of the laser in vacuum; used where the program corrects for the air",
            "number",
            find_out="the vacuum wavelength in the laser's certificate; by default that of any helium-neon laser",
        ),
        Question(
            "air.formula",
            "Refractive index",
            "equation, used where the program corrects for the air",
            "choice",
            (Choice("ciddor"), Choice("edlen", "modified equation of the NIST")),
        ),
    ]


def _environment(answer: Answer) -> list[Question]:
    driver = answer("environment.driver")
    modbus = [
        Question(
            "environment.map",
            "Register map",
            "of the sensor; generic knows no register: [[environment.settings.points]] lists them by hand",
            "choice",
            (
                Choice("vaisala", "Vaisala's common map"),
                Choice("comet_web", "Comet Web Sensor"),
                Choice("comet_rtu", "Comet RTU"),
                Choice("generic", "registers of your own"),
            ),
        ),
        Question(
            "environment.pressure_register",
            "Pressure register",
            "as the sensor's manual numbers it; 44 is that of the emulator and of a DPT145",
            "number",
            find_out="in the sensor's manual; without the pressure the program cannot correct for the air",
        ),
    ]
    return [
        Question(
            "environment.driver",
            "Driver",
            "which sensor measures the air",
            "choice",
            drivers_of("environment"),
        ),
        *(modbus if driver == "modbus-air" else []),
        Question(
            "environment.endpoint",
            "Endpoint",
            "tcp://192.168.0.30:502 or serial:///dev/ttyUSB1?baud=19200&parity=N&stopbits=2",
            find_out="the sensor's address, or the port and settings of its serial line: its manual or display",
        ),
        *setting_questions("environment", driver, frozenset({"map", "pressure_address"})),
    ]


def _more(answer: Answer) -> list[Question]:
    io, tracker, material = (answer(section) == "yes" for section in OPTIONAL)
    asked = [Question("io", "Door and lights?", "remote inputs and outputs: [io]", "choice", YES_NO)]
    if io:
        asked += [
            Question("io.driver", "  Driver", "of the block", "choice", drivers_of("io")),
            Question("io.endpoint", "  Endpoint", "tcp://192.168.0.40:502", find_out="the block's address"),
            *setting_questions("io", answer("io.driver"), frozenset()),
        ]
    if answer(SYSTEM) != SIX_AXIS:
        asked.append(
            Question("tracker", "Tracker?", "laser tracker or optical CMM: [tracker]", "choice", YES_NO)
        )
        asked += _tracker(answer) if tracker else []
    asked.append(
        Question("material", "Temperature of links?", "a sensor on the arm: [material]", "choice", YES_NO)
    )
    return [*asked, *(_material() if material else [])]


def _tracker(answer: Answer, before: str = "  ", *, places: Sequence[Question] = ()) -> list[Question]:
    """Return what is asked about a tracker; what every bench has of its own comes before settings with defaults."""
    return [
        Question("tracker.driver", f"{before}Driver", _TRACKERS, "choice", drivers_of("tracker")),
        Question(
            "tracker.endpoint",
            f"{before}Endpoint",
            "leica-emscon: tcp://192.168.0.1:700; t2sa: the computer of SpatialAnalyzer; file: "
            "file:///folder/readings.csv; bench-tracker: the emulated bench's control port",
            find_out="the tracker's address, or the file into which its own program writes",
        ),
        *places,
        *setting_questions("tracker", answer("tracker.driver"), frozenset()),
    ]


def _material() -> list[Question]:
    return [
        Question("material.sensor", "  Name of sensor", "a name of your own: links"),
        Question("material.device.driver", "  Driver", "of that sensor", "choice", drivers_of("environment")),
        Question("material.device.endpoint", "  Endpoint", _ENDPOINT, find_out="the sensor's address"),
        Question(
            "material.cte_per_k",
            "  Expansion, 1/K",
            "of the links: steel about 11.5e-6, aluminium 23.6e-6",
            "number",
            find_out="what the links are made of: ask the arm's manufacturer",
        ),
        Question("material.u_cte_per_k", "  u(expansion), 1/K", "standard uncertainty", "number"),
        Question("material.u_temperature_k", "  u(temperature), K", "standard uncertainty", "number"),
    ]


OPTIONAL: Final = ("io", "tracker", "material")
"""Sections that a cell may have or not."""

SYSTEM: Final = "system"
"""Key of the question that chooses one; no cell file has it."""

PAGES: Final = (
    Page("file", "Cell", "Which bench is this?", _file),
    Page("robot", "Robot", "Controller, nominal arm and limits.", _robot, "robot", SCARA),
    Page("robot", "Robot", "Controller, arm and limits.", _any_robot, "robot", RESOLUTION),
    Page("robot", "Robot", "Controller, arm, tool and limits.", _arm_with_targets, "robot", SIX_AXIS),
    Page(
        "tracker",
        "Tracker",
        six_axis.TRACKER,
        lambda answer: _tracker(answer, "", places=six_axis.places()),
        "tracker",
        SIX_AXIS,
    ),
    Page(
        "ballbar",
        "Ballbar",
        "The bar, and where its cup stands.",
        lambda _: six_axis.ballbar(),
        system=SIX_AXIS,
    ),
    Page(
        "interferometer",
        "Interferometer",
        "The length counter.",
        _interferometer,
        "interferometer",
        without=SIX_AXIS,
    ),
    Page(
        "environment",
        "Air sensor",
        "Temperature, pressure, humidity.",
        _environment,
        "environment",
        without=SIX_AXIS,
    ),
    Page("optics", "Optics", "The beam, and what stands in its way.", lambda _: optics(), system=SCARA),
    Page("angular_optics", "Optics", resolution.OPTICS, lambda _: resolution.optics(), system=RESOLUTION),
    Page("reflector", "Reflectors", REFLECTORS, lambda _: (), system=SCARA),
    Page(
        "measurement",
        "Measurement",
        "Nodes of the maps, and timing.",
        lambda _: measurement(),
        system=SCARA,
    ),
    Page("more", "More", "What not every bench has.", _more, "io"),
    Page("summary", "Summary", "What will be written, and what you still have to find out.", lambda _: ()),
)


def pages_of(system: str) -> tuple[Page, ...]:
    """Return the pages that are asked for a system, in order."""
    return tuple(page for page in PAGES if page.system in {"", system} and page.without != system)
