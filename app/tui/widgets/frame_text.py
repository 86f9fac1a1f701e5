"""What stands in the frame of a panel; Textual paints the whole panel anew each time that it is set."""

from textual.content import Content
from textual.widget import Widget


def set_title(panel: Widget, title: str | Content) -> None:
    """Set what stands in the upper edge, if it is something else."""
    if _is_other(panel, panel.border_title, title):
        panel.border_title = title


def set_subtitle(panel: Widget, subtitle: str | Content) -> None:
    """Set what stands in the lower edge, if it is something else."""
    if _is_other(panel, panel.border_subtitle, subtitle):
        panel.border_subtitle = subtitle


def _is_other(panel: Widget, markup: str | None, text: str | Content) -> bool:
    return panel.render_str(text).markup != markup
