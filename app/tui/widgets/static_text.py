"""A text that is painted anew only when it is another."""

from textual.content import Content
from textual.widgets import Static


class StaticText(Static):
    """Lines of text with styles; nothing in them is markup."""

    def __init__(self, *, id: str | None = None, classes: str | None = None) -> None:
        super().__init__("", id=id, classes=classes, markup=False)
        self._text = Content("")

    @property
    def text(self) -> Content:
        """What is shown."""
        return self._text

    def set_text(self, text: Content) -> None:
        """Show a text; nothing is laid out anew where its place does not depend on it."""
        if not text.is_same(self._text):
            self._text = text
            self.update(text, layout=self.styles.auto_dimensions)


def lines(*each: Content) -> Content:
    """Return lines one below the other."""
    return Content("\n").join(each)
