"""Questions to a person at a terminal: how they read, and what a typed line means."""

from collections.abc import Mapping
from typing import Literal

from catseye.app.engine.operator import fault_of
from catseye.procedures.kit.context import Json, Prompt

MOTION_WORD = "move"
"""Typed, not a key, before the arm moves: nobody types it by mistake."""

_Kind = Literal["confirm", "choice", "number", "text"]
_KINDS: dict[str, _Kind] = {"confirm": "confirm", "choice": "choice", "number": "number", "text": "text"}


def prompt_of(event: Mapping[str, Json]) -> Prompt:
    """Return the prompt of an event or a snapshot."""
    choices = event.get("choices")
    timeout_s = event.get("timeout_s")
    task = event.get("task")
    return Prompt(
        id=str(event["id"]),
        kind=_KINDS[str(event["kind"])],
        text=str(event["text"]),
        choices=tuple(str(choice) for choice in choices) if isinstance(choices, list) else (),
        unit=str(event.get("unit") or ""),
        timeout_s=float(timeout_s) if isinstance(timeout_s, (int, float)) else None,
        safe_answer=None if event.get("safe_answer") is None else str(event["safe_answer"]),
        task=task if isinstance(task, dict) else None,
        motion=event.get("motion") is True,
    )


def hint(prompt: Prompt) -> str:
    """Return what can be typed."""
    match prompt.kind:
        case "confirm" if prompt.motion:
            return f"the arm moves: type {MOTION_WORD}, or no"
        case "confirm":
            return "yes or no"
        case "choice":
            return " | ".join(prompt.choices)
        case "number":
            return f"a number{f' in {prompt.unit}' if prompt.unit else ''}"
        case "text":
            return "a line of text"


def answer_of(prompt: Prompt, typed: str) -> tuple[str, str]:
    """Return the answer that a typed line means, and why it is none; one of the two is empty.

    An empty line is never an answer: nobody passes a question by leaning on Enter.
    """
    text = typed.strip()
    if not text:
        return "", f"type {hint(prompt)}"
    if prompt.kind == "confirm":
        text = text.lower()
        if prompt.motion and text in {"yes", "y"}:
            return "", f"the arm moves after this: type {MOTION_WORD}, or no"
        text = {"y": "yes", "n": "no"}.get(text, text)
        if prompt.motion and text == MOTION_WORD:
            text = "yes"
    fault = fault_of(prompt, text)
    return ("", fault) if fault else (text, "")
