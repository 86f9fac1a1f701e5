"""procedures: what can be run, and what may be chosen."""

from app.commands.output import emit, emit_json
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
            emit(f"    {key} = {facts.get('default')}  {facts.get('description', '')}{_range(facts)}")


def _range(facts: dict[str, object]) -> str:
    low = facts.get("minimum", facts.get("exclusiveMinimum"))
    high = facts.get("maximum", facts.get("exclusiveMaximum"))
    return (
        ""
        if low is None and high is None
        else f" ({low if low is not None else ''}…{high if high is not None else ''})"
    )
