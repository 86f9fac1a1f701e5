"""Questions to a person at a terminal: how they read, and what a typed line means."""

from catseye.procedures.kit.context import Prompt

MOTION_WORD = "move"
"""Typed, not a key, before the arm moves: nobody types it by mistake."""


def hint(prompt: Prompt) -> str:
    """Return what can be typed."""
    match prompt.kind:
        case "confirm" if prompt.moves_after("yes"):
            return f"the arm moves: type {MOTION_WORD}, or no"
        case "confirm":
            return "yes or no"
        case "choice":
            return " | ".join(prompt.choices)
        case "number":
            return f"a number{prompt.in_unit}"
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
        moves = prompt.moves_after("yes")
        if moves and text in {"yes", "y"}:
            return "", f"the arm moves after this: type {MOTION_WORD}, or no"
        text = {"y": "yes", "n": "no"}.get(text, text)
        if moves and text == MOTION_WORD:
            text = "yes"
    fault = prompt.fault_of(text)
    return ("", fault) if fault else (text, "")
