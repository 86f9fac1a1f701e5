"""A cell file in the making: typed answers over the values that it began with."""

import copy
import itertools
import tomllib
from collections.abc import Callable, Iterator, Mapping
from typing import Any, Final

from pydantic import ValidationError

from catseye.app.cell.load import cell_fault_text
from catseye.app.cell.model import Cell
from catseye.app.cell.rewriting import CommentsLostError, plain, rewritten
from catseye.app.cell.templates import SCARA, SIX_AXIS, TEMPLATES, system_of
from catseye.app.cell.wizard.pages import OPTIONAL, SYSTEM, Page, pages_of
from catseye.app.cell.wizard.question import Question, number_of, numbers_of, text_of
from catseye.app.cell.wizard.six_axis.questions import FEWEST_NESTS, NEST
from catseye.app.errors import ConfigError
from catseye.app.files.documents import parse_toml

Data = dict[str, Any]
Reflector = dict[str, str]

_OF_ONE_BENCH: Final = (
    "name",
    "robot.endpoint",
    "interferometer.endpoint",
    "interferometer.profile",
    "environment.endpoint",
    "environment.pressure_register",
    "tracker",
    "angular_optics.spacing_mm",
)
"""What the templates say of the emulated bench and nobody knows of another one."""

_OF_ONE_SERIAL_BENCH: Final = (
    "tracker.endpoint",
    "tracker.control",
    "tracker.base_mm",
    "tracker.base_deg",
    "tracker.nest",
)
"""Likewise of a serial arm, whose tracker is no option."""

_OF_DRIVER: Final = {
    "robot": ("settings", "datalink_endpoint", "mxt_endpoint"),
    "interferometer": ("settings", "profile"),
    "environment": ("settings", "map", "pressure_register"),
    "io": ("settings",),
}
"""Keys that mean something to one driver only."""

_OF_ANY_SYSTEM: Final = ("file", "name")
"""Answers that stay when another system is chosen."""

_ELSEWHERE: Final = {
    "name": "file",
    "format": "file",
    "air": "interferometer",
    "device": "more",
    "linear_optics": "angular_optics",
}
"""Pages of sections that have none of their own name."""

_PLACE: Final = ("x_mm", "y_mm", "z_mm")

_REFLECTOR_KEYS: Final = ("name", "x_mm", "y_mm", "facing_deg")


class Draft:
    """Answers, and what becomes of them.

    Args:
        text: of the file whose comments and further values are kept.

    Attributes:
        beginning: text that it began with.
        system: that the cell is for.
        reflectors: as they are typed.
    """

    def __init__(self, text: str, data: Data) -> None:
        self._new = False
        self._typed: dict[str, str] = {}
        self._begin(text, data)

    def _begin(self, text: str, data: Data) -> None:
        self.beginning = text
        self.system = system_of(data)
        self._base = data
        self.reflectors: list[Reflector] = [
            {key: text_of(entry.get(key)) for key in _REFLECTOR_KEYS} for entry in _tables(data, "reflector")
        ]

    @classmethod
    def new(cls, system: str = SCARA) -> "Draft":
        """Return the beginning of a new file: what everybody has, nothing of what only this bench has."""
        draft = cls(TEMPLATES[system].text, _unanswered(system))
        draft._new = True  # its own
        return draft

    @classmethod
    def of_text(cls, text: str) -> "Draft":
        """Return the beginning of a change to a file, faults included.

        Raises:
            ConfigError: it is no TOML, or no table can be read from it.
        """
        try:
            data = parse_toml(text, "this file")
        except ConfigError as error:
            raise ConfigError(f"{error}; correct it with an editor first") from error
        if not str(data.get("format", "")).startswith("catseye-cell/"):
            raise ConfigError('not a cell file: its first key has to be format = "catseye-cell/1"')
        return cls(text, data)

    def answer(self, key: str) -> str:
        """Return the present answer to a question as it would be typed; empty when there is none."""
        if key == SYSTEM:
            return self.system
        if key in self._typed:
            return self._typed[key]
        if key in OPTIONAL:
            return "yes" if key in self._base else "no"
        if key.startswith(NEST):
            return text_of(self._nest(key))
        value = _get(self._base, key)
        if value is None and key.startswith("material.device."):
            return text_of(self._material_device().get(key.rpartition(".")[2]))
        return text_of(value if value is not None else _default(key) if key.endswith(".driver") else None)

    def give(self, key: str, text: str) -> None:
        """Take an answer; another driver begins without the settings of the one before, another system anew."""
        if key == SYSTEM:
            if self._new and text in TEMPLATES and text != self.system:
                self._typed = {known: self._typed[known] for known in _OF_ANY_SYSTEM if known in self._typed}
                self._begin(TEMPLATES[text].text, _unanswered(text))
            return
        section, _, name = key.rpartition(".")
        if name == "driver" and section in _OF_DRIVER and text != self.answer(key):
            for own in _OF_DRIVER[section]:
                _remove(self._base, f"{section}.{own}")
                self._forget(f"{section}.{own}")
        self._typed[key] = text.strip()

    def questions(self, page: Page) -> tuple[Question, ...]:
        """Return what is asked on a page as things are; the system of a file that is there is not."""
        asked = page.questions(self.answer)
        return tuple(question for question in asked if self._new or question.key != SYSTEM)

    @property
    def pages(self) -> tuple[Page, ...]:
        """What is asked for the system, in order."""
        return pages_of(self.system)

    def data(self) -> Data:
        """Return the values of the file, right or wrong."""
        data = copy.deepcopy(self._base)
        data.setdefault("format", "catseye-cell/1")
        for question in self._asked():
            if question.key in self._typed and not question.key.startswith(
                ("file", "material.device.", NEST)
            ):
                text = self._typed[question.key]
                _set(data, question.key, question.value(text) if text else None)
        for section in OPTIONAL:
            if section == "tracker" and self.system == SIX_AXIS:
                continue
            if self.answer(section) == "no":
                data.pop(section, None)
            elif not isinstance(data.get(section), dict):
                data[section] = {}
        self._put_material_device(data)
        self._put_nests(data)
        reflectors = [_reflector(one) for one in self.reflectors]
        if reflectors != _tables(data, "reflector"):
            data["reflector"] = self._with_further_keys(reflectors)
        return data

    def faults(self, require_drivers: Callable[[Cell], None]) -> dict[str, str]:
        """Return what is wrong by key, in the words of the cell file's model and of the drivers' own.

        Args:
            require_drivers: raises ConfigError where a driver is not installed or refuses a setting.
        """
        data = self.data()
        try:
            cell = Cell.model_validate(data)
        except ValidationError as error:
            # What follows from an answer that is missing itself is no fault of its own.
            faults = [fault for fault in error.errors() if fault["type"] != "default_factory_not_called"]
            found = {self._asked_at(fault["loc"]): cell_fault_text(fault) for fault in reversed(faults)}
            return found | self._nest_faults()
        try:
            require_drivers(cell)
        except ConfigError as error:
            return _driver_fault(str(error))
        return {}

    def page_faults(self, page: Page, faults: Mapping[str, str]) -> dict[str, str]:
        """Return those faults that belong to a page, by the question that they stand beside.

        What belongs to no question of the page stands under the page's own name.
        """
        keys = [question.key for question in self.questions(page)]
        found: dict[str, str] = {}
        for place, text in faults.items():
            near = [key for key in keys if place == key or place.startswith(f"{key}.")]
            if near:
                found[max(near, key=len)] = text
            elif page.name == _page_of(place, {each.name for each in self.pages}):
                # A line of a table keeps its place, so that it can stand beside that line.
                found[place if page.name == "reflector" and "." in place else page.name] = text
        return found

    def to_find_out(self) -> list[str]:
        """Return what nobody has answered and what the person at the bench has to find out."""
        found = [
            f"{place}: {question.find_out}" for place, question in self._unanswered() if not question.without
        ]
        if self.answer("interferometer.profile") == "distax":
            found.append(
                "Interferometer, Profile: a DISTAX's protocol is not published: copy the profile, complete it with "
                "the manual and catseye terminal (docs/guide.md, section 2), and give the copy's path"
            )
        return found

    def left_open(self) -> list[str]:
        """Return what may stay unanswered, what that costs, and what had to be found out."""
        return [
            f"{place}: {question.without}; to find out: {question.find_out}"
            for place, question in self._unanswered()
            if question.without
        ]

    def _unanswered(self) -> Iterator[tuple[str, Question]]:
        """Yield what somebody has to find out, with page and title."""
        for page in self.pages:
            for question in self.questions(page):
                if question.find_out and not self.answer(question.key):
                    yield f"{page.title}, {question.title.strip()}", question

    def text(self) -> str:
        """Return the file.

        Raises:
            CommentsLostError: it can be written only without the comments of the one it began with.
        """
        return rewritten(self.beginning, self.data())

    def plain(self) -> str:
        """Return the file without comments."""
        return plain(self.data())

    def written(self) -> tuple[str, bool]:
        """Return the file, and whether the comments are kept."""
        try:
            return self.text(), True
        except CommentsLostError:
            return self.plain(), False

    def _asked(self) -> Iterator[Question]:
        for page in self.pages:
            yield from self.questions(page)

    def _forget(self, beginning: str) -> None:
        for key in [key for key in self._typed if key == beginning or key.startswith(f"{beginning}.")]:
            del self._typed[key]

    def _with_further_keys(self, reflectors: list[Data]) -> list[Data]:
        """Keep what the file says of a reflector beyond the questions."""
        known = {entry.get("name"): entry for entry in _tables(self._base, "reflector")}
        return [
            {k: v for k, v in known.get(one.get("name"), {}).items() if k not in _REFLECTOR_KEYS} | one
            for one in reflectors
        ]

    def _nest(self, key: str) -> list[Any] | None:
        """Return the place of a nest as the file has it."""
        nests, number = _tables(_get(self._base, "tracker") or {}, "nest"), int(key.removeprefix(NEST))
        return [nests[number].get(name) for name in _PLACE] if number < len(nests) else None

    def _put_nests(self, data: Data) -> None:
        """Write the lines of the nests on the table, as the answers have them."""
        if self._nests_typed:
            data.setdefault("tracker", {})["nest"] = [one for _, one in self._nests()]

    @property
    def _nests_typed(self) -> bool:
        return any(key.startswith(NEST) for key in self._typed)

    def _nests(self) -> list[tuple[int, Data]]:
        """Return the nests on the table that have an answer, each with the number of its question."""
        known = _tables(_get(self._base, "tracker") or {}, "nest")
        taken = {one.get("name") for one in known}
        found = []
        for number in range(max(FEWEST_NESTS, len(known))):
            typed = self._typed.get(f"{NEST}{number}")
            if typed == "" or (typed is None and number >= len(known)):
                continue
            new = next(name for k in itertools.count(number + 1) if (name := f"W{k}") not in taken)
            one = dict(known[number]) if number < len(known) else {"name": new}
            if typed is not None:
                # The model refuses a text, and so the file.
                one |= _place_of(typed) or {_PLACE[0]: typed}
            taken.add(one.get("name"))
            found.append((number, one))
        return found

    def _asked_at(self, place: tuple[int | str, ...]) -> str:
        """Return the key of a fault of the file; the nests that have no answer are questions, too."""
        key = _dotted(place)
        if not (self._nests_typed and key.startswith(NEST)):
            return key
        index, dot, rest = key.removeprefix(NEST).partition(".")
        return f"{NEST}{self._nests()[int(index)][0]}{dot}{rest}"

    def _nest_faults(self) -> dict[str, str]:
        """Return which nests were typed without exactly three numbers."""
        typed = ((key, text) for key, text in self._typed.items() if key.startswith(NEST) and text)
        return {key: "give three numbers: x, y, z in mm" for key, text in typed if not _place_of(text)}

    def _material_device(self) -> Data:
        name = _get(self._base, "material.sensor")
        return next((one for one in _tables(self._base, "device") if one.get("name") == name), {})

    def _put_material_device(self, data: Data) -> None:
        """Write the [[device]] that measures the links, as the answers have it."""
        typed = {key: self._typed.get(f"material.device.{key}") for key in ("driver", "endpoint")}
        name = _get(data, "material.sensor")
        if name is None or (not any(typed.values()) and self._material_device().get("name") == name):
            return
        answers = {key: self.answer(f"material.device.{key}") for key in ("driver", "endpoint")}
        entry = {"name": name, **{key: text for key, text in answers.items() if text}}
        others = [one for one in _tables(data, "device") if one.get("name") != name]
        data["device"] = [*others, entry]


def _place_of(typed: str) -> Data:
    """Return a typed place by the keys of its coordinates; nothing where there are not three."""
    place = numbers_of(typed)
    exact = isinstance(place, list) and len(place) == len(_PLACE)
    return dict(zip(_PLACE, place, strict=True)) if exact else {}


def _unanswered(system: str) -> Data:
    """Return the values of a template without those that nobody knows of another bench."""
    data = tomllib.loads(TEMPLATES[system].text)
    of_serial = [key for key in _OF_ONE_BENCH if key != "tracker"]
    for key in (*of_serial, *_OF_ONE_SERIAL_BENCH) if system == SIX_AXIS else _OF_ONE_BENCH:
        _remove(data, key)
    return data


def _driver_fault(text: str) -> dict[str, str]:
    """Return the key that a sentence about `[section] key: …` belongs to."""
    section, _, rest = text.removeprefix("[").partition("]")
    key, found, words = rest.strip().partition(":")
    if found and key and " " not in key:
        return {f"{section}.{'driver' if key == 'driver' else f'settings.{key}'}": words.strip()}
    return {section: rest.lstrip(": ")}


def _page_of(place: str, names: set[str]) -> str:
    """Return the page of a section's faults.

    Args:
        names: of the pages that are asked.
    """
    section = place.split(".", 1)[0]
    usual = "more" if section in OPTIONAL and section not in names else section
    page = _ELSEWHERE.get(section, usual)
    return page if page in names else "summary"


def _reflector(typed: Reflector) -> Data:
    numbers = {key: number_of(typed[key]) for key in _REFLECTOR_KEYS[1:] if typed.get(key)}
    return {**({"name": typed["name"]} if typed.get("name") else {}), **numbers}


def _dotted(place: tuple[int | str, ...]) -> str:
    return ".".join(str(part) for part in place)


def _tables(data: Data, key: str) -> list[Data]:
    found = data.get(key)
    return [one for one in found if isinstance(one, dict)] if isinstance(found, list) else []


def _get(data: Data, key: str) -> Any:
    here: Any = data
    for part in key.split("."):
        here = here.get(part) if isinstance(here, dict) else None
    return here


def _set(data: Data, key: str, value: Any) -> None:
    """Set a key; None takes it out."""
    if value is None:
        _remove(data, key)
        return
    *tables, last = key.split(".")
    if key in OPTIONAL:
        return
    here = data
    for part in tables:
        if not isinstance(here.get(part), dict):
            here[part] = {}
        here = here[part]
    here[last] = value


def _remove(data: Data, key: str) -> None:
    *tables, last = key.split(".")
    here: Any = data
    for part in tables:
        here = here.get(part) if isinstance(here, dict) else None
    if isinstance(here, dict):
        here.pop(last, None)


def _default(key: str) -> Any:
    """Return the default of a key in the cell file's model; None when there is none."""
    model: Any = Cell
    *tables, last = key.split(".")
    for part in tables:
        field = getattr(model, "model_fields", {}).get(part)
        kinds = getattr(field.annotation, "__args__", (field.annotation,)) if field else ()
        model = next((kind for kind in kinds if hasattr(kind, "model_fields")), None)
    field = getattr(model, "model_fields", {}).get(last)
    # A default that follows from other answers is the model's alone.
    if field is None or field.is_required() or field.default_factory_takes_validated_data:
        return None
    return field.get_default(call_default_factory=True)


def default_text(key: str) -> str:
    """Return what is taken when a question is left unanswered; empty when nothing is."""
    default = _default(key)
    return text_of(default) if not isinstance(default, (dict, Mapping)) else ""


def with_one_device(data: Data, device: str) -> Data:
    """Return a whole cell file in which one device is as the answers have it, to test its connection.

    Args:
        data: values of the file in the making, right or wrong.
        device: robot, interferometer, environment, io or tracker.
    """
    whole = tomllib.loads(TEMPLATES[system_of(data)].text)
    sections = {device, *({"air"} if device == "interferometer" else ())}
    return whole | {key: data[key] for key in sections if key in data}
