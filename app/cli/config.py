"""init and config: writing, checking and showing cell files."""

import json
from pathlib import Path

from catseye.app.cell.load import load_cell
from catseye.app.cell.model import Cell
from catseye.app.cell.plausible import implausible
from catseye.app.cell.template import TEMPLATE
from catseye.app.cli.output import emit, emit_json, say
from catseye.app.engine.interlock import NO_DOOR
from catseye.app.errors import ConfigError, UsageError
from catseye.app.files.atomic import write_atomically
from catseye.app.instruments import device_builder
from catseye.drivers.links.endpoint import TcpEndpoint, parse_endpoint
from catseye.drivers.roles.clock import SystemClock

_LOOPBACK = {"127.0.0.1", "localhost", "::1"}


def init_command(file: Path) -> None:
    """Write the template; an existing file is never overwritten."""
    if file.exists():
        raise UsageError(f"{file} exists already; choose another name or remove it")
    if not file.parent.is_dir():
        raise UsageError(f"{file.parent} is no folder; make it first")
    write_atomically(file, TEMPLATE)
    say(f"{file} written. Next: catseye emulate {file}, and in another terminal: catseye doctor {file}")


def validate_command(file: Path, as_json: bool) -> None:
    """Check a cell file."""
    loaded = load_cell(file)
    doubts = [*_trouble_with_devices(loaded.cell), *_no_door(loaded.cell), *implausible(loaded.cell)]
    if as_json:
        facts = {"file": str(file), "valid": True, "name": loaded.cell.name, "sha256": loaded.sha256}
        emit_json({**facts, "warnings": doubts})
    else:
        say(f"{file}: cell {loaded.cell.name} is valid")
    for text in doubts:
        say(f"warning: {text}")


def _trouble_with_devices(cell: Cell) -> list[str]:
    """Return what this installation cannot drive: an unknown driver or profile, a link that it does not have."""
    try:
        device_builder(cell, SystemClock())
    except ConfigError as error:
        return [str(error)]
    return []


def _no_door(cell: Cell) -> list[str]:
    """Return that no door is watched, unless the robot's endpoint is of this machine as an emulator's is."""
    endpoint = parse_endpoint(cell.robot.endpoint)
    emulated = isinstance(endpoint, TcpEndpoint) and endpoint.host in _LOOPBACK
    return [] if emulated or cell.io is not None else [NO_DOOR]


def show_command(file: Path, as_json: bool) -> None:
    """Show each value with its origin."""
    loaded = load_cell(file)
    values = _flat(loaded.cell.model_dump(mode="json"))
    if as_json:
        emit_json(
            {
                "file": str(file),
                "sha256": loaded.sha256,
                "configuration": loaded.cell.model_dump(mode="json"),
                "origins": loaded.origins,
            }
        )
        return
    for key, origin in loaded.origins.items():
        emit(f"{key} = {json.dumps(values.get(key), ensure_ascii=False)}  # {origin}")


def schema_command(file: Path | None) -> None:
    """Print the JSON schema; a file that is named has to be there, and is left as it is."""
    if file is not None and not file.is_file():
        raise UsageError(f"{file}: there is no such file; the schema needs none: catseye config schema")
    emit(json.dumps(Cell.model_json_schema(), indent=2, ensure_ascii=False))


def _flat(value: object, prefix: str = "") -> dict[str, object]:
    if isinstance(value, dict):
        parts = [(f"{prefix}.{key}" if prefix else str(key), inner) for key, inner in value.items()]
    elif isinstance(value, list) and value and isinstance(value[0], dict):
        parts = [(f"{prefix}[{i}]", inner) for i, inner in enumerate(value, 1)]
    else:
        return {prefix: value}
    return {key: item for name, inner in parts for key, item in _flat(inner, name).items()}
