"""Procedures by name: built-in and third-party ones register through entry points."""

import difflib
import math
from collections.abc import Callable, Collection
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Any, Protocol

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from catseye.app.errors import ConfigError, UsageError
from catseye.app.files.documents import document_text, parse_json, parse_toml, read_document
from catseye.app.protocol.installed import GROUP, procedure_names
from catseye.app.protocol.parameters import names_in, range_text, takes_names
from catseye.drivers.roles.registry import why_not_loaded
from catseye.procedures.kit.bench import Bench
from catseye.procedures.kit.columns import Columns, DocumentRule, TableRule
from catseye.procedures.kit.context import Context
from catseye.procedures.kit.needs import Basis, Needs
from catseye.procedures.kit.procedure import Procedure
from catseye.procedures.kit.records import Record


class Executable(Protocol):
    """What an engine carries out: a procedure, or the walk through one, once its plan is made.

    Attributes:
        name: as on the command line and in the run's name.
        title: one line for people.
        records: types of what it records.
        sets_up_anew: what somebody has moved before a run is resumed is set up anew where it is still needed.
    """

    @property
    def name(self) -> str: ...  # noqa: D102  # said above
    @property
    def title(self) -> str: ...  # noqa: D102  # said above
    @property
    def records(self) -> Collection[type[Record]]: ...  # noqa: D102  # said above
    @property
    def sets_up_anew(self) -> bool: ...  # noqa: D102  # said above

    # Each procedure has parameters and a plan of types of its own, which only it and its planner know.
    async def run(self, ctx: Context, plan: Any) -> None:
        """Carry the plan out, step by step."""
        ...

    async def teardown(self, ctx: Context) -> None:
        """Leave the bench as it should be; the robot cannot be moved after a stop."""
        ...


class Runnable(Executable, Protocol):
    """What can be planned and run.

    Attributes:
        needs: of a cell.
        params_type: what may be chosen.
    """

    @property
    def needs(self) -> Needs: ...  # noqa: D102  # said above
    @property
    def params_type(self) -> type[BaseModel]: ...  # noqa: D102  # said above

    def equipped(self, bench: Bench, params: Any) -> Bench:
        """Return the bench as a run finds and makes it."""
        ...

    def plan(self, bench: Bench, params: Any) -> Any:
        """Plan everything before anything moves."""
        ...


def procedures() -> list[Procedure]:
    """Return all installed procedures, by name, without those that cannot be loaded: see `broken_procedures`."""
    return [make() for make in loadable()[0]]


def broken_procedures() -> tuple[str, ...]:
    """Return why procedures cannot be loaded; the others work without them."""
    return loadable()[1]


@cache
def loadable() -> tuple[tuple[Callable[[], Procedure], ...], tuple[str, ...]]:
    """Return what makes the procedures, by name, and why others cannot be loaded.

    They are looked for once in a process: each look reads the records of every installed package.
    """
    found = {entry.name: entry for entry in metadata.entry_points(group=GROUP)}
    working, broken = [], []
    for name in sorted(found):
        try:
            working.append(_loaded(found[name]))
        except UsageError as error:
            broken.append(str(error))
    return tuple(working), tuple(broken)


def _loaded(entry: metadata.EntryPoint) -> Callable[[], Procedure]:
    try:
        make: Callable[[], Procedure] = entry.load()
        # What cannot be made is as broken as what cannot be imported.
        make()
    except Exception as error:  # what a package of somebody else does when it is imported may raise anything
        raise UsageError(why_not_loaded("procedure", entry, error)) from error
    return make


def on_the_way() -> list[Procedure]:
    """Return the procedures that have a stage, in the order of their stages."""
    staged = [(each.stage.order, each.name, each) for each in procedures() if each.stage is not None]
    return [each for _, _, each in sorted(staged)]


def analysed_by(command: str) -> list[Procedure]:
    """Return the procedures on whose runs a command works."""
    return [each for each in procedures() if any(one.command == command for one in each.analyses)]


def bases(bench: Bench) -> list[Basis]:
    """Return what plans on a bench are made from, each once."""
    declared = (each.needs for each in procedures() if isinstance(bench, each.needs.bench))
    return list(dict.fromkeys(needs.basis for needs in declared if needs.basis is not None))


def declared_by(name: str) -> Procedure | None:
    """Return the procedure of a run; None where it is not installed, or the run is none of a procedure."""
    return load_procedure(name) if name in procedure_names() else None


@cache
def point_name(procedure: str) -> str:
    """Return what one of the things is called that a procedure measures."""
    declared = declared_by(procedure)
    points = [] if declared is None else [each for each in declared.records if each.is_point]
    return points[0].point_name if points else Record.point_name


def load_procedure(name: str) -> Procedure:
    """Return a procedure.

    Raises:
        UsageError: no such procedure, or it cannot be loaded; the text lists those that are installed.
    """
    for entry in metadata.entry_points(group=GROUP, name=name):
        return _loaded(entry)()
    names = procedure_names()
    close = difflib.get_close_matches(name, names, n=1, cutoff=0.4)
    meant = f"; did you mean {close[0]}?" if close else "."
    raise UsageError(f"there is no procedure {name!r}{meant} Installed are: {', '.join(names)}")


def parse_params(params_type: type[BaseModel], given: list[str]) -> BaseModel:
    """Return the parameters that `--param k=v` texts choose.

    Raises:
        UsageError: a text is no k=v, a key is unknown, or a value is wrong.
    """
    values: dict[str, Any] = {}
    for text in given:
        key, equals, value = text.partition("=")
        if not equals:
            raise UsageError(f"--param {text!r} has to be name=value, for instance --param poses=10")
        values[key.strip()] = _given_value(params_type, key.strip(), value.strip())
    try:
        return params_type.model_validate(values)
    except ValidationError as error:
        raise UsageError(_explain(params_type, error)) from error


def _given_value(params_type: type[BaseModel], key: str, text: str) -> Any:
    """Return a value; where a parameter takes the rows of a file, those rows, so that a run holds what it drove."""
    field = params_type.model_fields.get(key)
    value = _toml_value(text)
    table = next((rule for rule in field.metadata if isinstance(rule, TableRule)), None) if field else None
    if not isinstance(value, str):
        return value
    if takes_names(params_type.model_json_schema()["properties"].get(key, {})) and not text.startswith("["):
        return names_in(value)
    if table is None:
        return _document(field, value) if field else value
    # Most commands read no such file, and start without what reads it.
    from catseye.app.files.columns import read_table
    from catseye.app.files.csv_lines import require_file

    require_file(Path(value))
    if table.named:
        return _named_poses(Path(value), table)
    return _rows(read_table(Path(value), table), table)


def _rows(columns: Columns, table: TableRule) -> list[Any]:
    """Return the rows of a table: by the names of their columns where a file need not have all of them."""
    if len(table.forms) == 1 and not any(column.optional for column in table.forms[0]):
        rows: list[Any] = columns.stacked([column.name for column in table.forms[0]]).tolist()
        return rows
    kinds = {column.name: column.kind for form in table.forms for column in form if column.name in columns}
    values = columns.stacked(list(kinds)).tolist()
    return [
        {
            name: int(value) if kind in ("integer", "direction") else value
            for (name, kind), value in zip(kinds.items(), row, strict=True)
            if not math.isnan(value)
        }
        for row in values
    ]


def _named_poses(path: Path, table: TableRule) -> list[Any]:
    from catseye.app.files.poses import read_poses, require_from_below

    found = read_poses(path, table)
    require_from_below(path, found)
    return [
        {"pose": name, "joints": joints, "rows": rows, "targets": list(targets)}
        for name, joints, rows, targets in zip(
            found.names, found.joints.tolist(), found.rows, found.targets, strict=True
        )
    ]


def _document(field: FieldInfo, value: str) -> Any:
    """Return the document of a file, so that a run holds what it was planned with; other texts as they are."""
    rule = next((one for one in field.metadata if isinstance(one, DocumentRule)), None)
    if rule is None:
        return value
    raw = read_document(Path(value))
    found = (
        parse_toml(document_text(raw, value), value) if value.endswith(".toml") else parse_json(raw, value)
    )
    if not isinstance(found, dict) or found.get("format") != rule.format:
        raise UsageError(f"{value} is not {rule.holds}, {rule.format}: name another file")
    return found


def _toml_value(text: str) -> Any:
    try:
        return parse_toml(f"value = {text}", "--param")["value"]
    except ConfigError:
        return text


def _explain(params_type: type[BaseModel], error: ValidationError) -> str:
    return "; ".join(_fault_text(params_type, fault) for fault in error.errors())


def _fault_text(params_type: type[BaseModel], fault: ErrorDetails) -> str:
    name = ".".join(str(part) for part in fault["loc"])
    if fault["type"] == "extra_forbidden":
        return f"--param {name}: unknown; known are {', '.join(params_type.model_fields)}"
    facts = params_type.model_json_schema()["properties"].get(fault["loc"][0] if fault["loc"] else None)
    if facts is None or fault["type"] == "value_error":
        return f"--param {name}: {fault['msg'].removeprefix('Value error, ')}"
    if fault["type"] == "missing":
        return f"--param {name}=… has to be given; it takes {range_text(facts)}"
    return f"--param {name}: {fault['input']} is not possible; it takes {range_text(facts)}"
