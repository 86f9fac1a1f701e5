"""What stands in the frame of a panel; Textual paints the whole panel anew each time that it is set.

Texts are set here alone: a plain one is no markup, and names in it may look like some.
"""

from textual.content import Content
from textual.widget import Widget


def set_title(panel: Widget, title: str | Content) -> None:
    """Set what stands in the upper edge, if it is something else."""
    content = _content(title)
    if panel.border_title != content.markup:
        panel.border_title = content


def set_subtitle(panel: Widget, subtitle: str | Content) -> None:
    """Set what stands in the lower edge, if it is something else."""
    content = _content(subtitle)
    if panel.border_subtitle != content.markup:
        panel.border_subtitle = content


def _content(text: str | Content) -> Content:
    return text if isinstance(text, Content) else Content(text)
