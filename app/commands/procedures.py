"""procedures: what can be run, and what may be chosen."""

from typing import Any

from app.commands.output import emit, emit_json
from app.parameter_words import range_text
from app.procedure_list import load_procedure, procedure_names


def procedures_command(as_json: bool) -> None:
    """List the installed procedures."""
    for name in procedure_names():
        procedure = load_procedure(name)
        schema = procedure.params_type.model_json_schema()["properties"]
        if as_json:
            emit_json({"name": name, "title": procedure.title, "params": schema})
            continue
        emit(f"{name}: {procedure.title}")
        for key, facts in schema.items():
            emit(f"    {key:<20} {facts.get('description', '')}")
            emit(f"    {'':<20} {range_text(facts)}{_default(facts)}")


def _default(facts: dict[str, Any]) -> str:
    value = facts.get("default")
    if value is None or value in ("", []):
        return ""
    text = str(value).lower() if isinstance(value, bool) else f"{value:g}" if _number(value) else str(value)
    return f"; default {text}"


def _number(value: object) -> bool:
    return isinstance(value, (int, float))
