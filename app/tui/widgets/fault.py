"""What is wrong with an answer."""

from textual.content import Content

from catseye.app.tui.widgets.static_text import StaticText


class Fault(StaticText):
    """What is wrong, below what it is about."""

    DEFAULT_CSS = """
    Fault { height: auto; color: $error; display: none; padding-left: 2; }
    Fault.shown { display: block; }
    """

    def show_fault(self, text: str) -> None:
        """Show a fault; an empty text hides it."""
        self.set_class(bool(text), "shown")
        self.set_text(Content(f"✗ {text}" if text else ""))
