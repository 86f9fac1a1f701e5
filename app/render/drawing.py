"""A drawn figure with its caption, as markup."""

from matplotlib.figure import Figure

from catseye.app.render.canvas import svg
from catseye.app.render.markup import Html, element


def figure(drawn: Figure, name: str, label: str, caption: str) -> Html:
    """Return a figure that scrolls by itself on a narrow screen.

    Args:
        drawn: the figure.
        name: unique word; the page can be linked to it.
        label: what it is, for a reader who cannot see it.
        caption: text below.
    """
    picture = element("div", Html(svg(drawn, name, label)), class_="scroll")
    return element("figure", picture, element("figcaption", caption), id_=f"figure-{name}")
