"""The glossary."""

from catseye.app.results.glossary import GLOSSARY
from catseye.app.tui.dialogs.search_dialog import Found, SearchDialog


def glossary_dialog() -> SearchDialog:
    """Return a dialog that searches the terms of the screens."""
    entries = tuple(Found(term.name, f"{term.name}:", term.text) for term in GLOSSARY)
    return SearchDialog("What the terms mean", entries, "? lists the keys of a screen", 0)
