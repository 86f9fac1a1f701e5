"""The same drawing in fewer bytes: a row of markers is one path, looks are said once, coordinates are rounded.

matplotlib writes every marker as an element with its whole style and every coordinate to a millionth of a point: a
page about a thousand distances is four times as large as it has to be.
"""

import re
from collections.abc import Iterator
from itertools import groupby
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

_SVG = "{http://www.w3.org/2000/svg}"
_LINK = "{http://www.w3.org/1999/xlink}href"
ElementTree.register_namespace("", _SVG[1:-1])
ElementTree.register_namespace("xlink", "http://www.w3.org/1999/xlink")

_COORDINATES = ("d", "x", "y", "width", "height", "points", "transform")
_NUMBER = re.compile(r"-?\d+\.\d+")
_OPACITY = re.compile(r"(^|;)\s*opacity")

_FEWEST = 3
"""Fewer siblings are left as they are."""


def compact(text: str) -> str:
    """Return a drawing that looks the same: each marker and each line is still drawn by itself.

    Args:
        text: SVG as matplotlib writes it.
    """
    root = ElementTree.fromstring(text)
    for element in root.iter():
        _tidy(element)
    markers = _Markers(root)
    for parent in list(root.iter()):
        parent[:] = list(_joined(parent, markers))
    return ElementTree.tostring(root, encoding="unicode")


def _tidy(element: Element) -> None:
    """Round coordinates to a hundredth of a point (4 µm on paper) and drop blanks between elements."""
    for key in _COORDINATES:
        if key in element.attrib:
            element.set(key, " ".join(_NUMBER.sub(_rounded, element.attrib[key]).split()))
    if "d" in element.attrib:
        element.set("d", re.sub(r" ?([A-Za-z]) ?", r"\1", element.attrib["d"]))
    if not (element.text or "").strip():
        element.text = None
    if not (element.tail or "").strip():
        element.tail = None


def _rounded(number: re.Match[str]) -> str:
    text = f"{float(number[0]):.2f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


class _Markers:
    """Markers that stand at the corners of a path, one for each shape and style.

    Args:
        root: holds the shapes that `use` elements refer to.
    """

    def __init__(self, root: Element) -> None:
        self._shapes = {f"#{element.get('id')}": element for element in root.iter() if "id" in element.attrib}
        self._known: dict[tuple[str, str], str] = {}

    def path(self, uses: list[Element]) -> Iterator[Element]:
        """Yield what draws one and the same shape wherever it was used."""
        link, style = uses[0].attrib[_LINK], uses[0].get("style", "")
        new = (link, style) not in self._known
        name = self._known.setdefault((link, style), f"k{len(self._known)}")
        if new:
            yield self._marker(name, link, style)
        corners = " ".join(f"{use.get('x')} {use.get('y')}" for use in uses)
        place = f"url(#{name})"
        yield Element(
            f"{_SVG}path",
            {"d": f"M{corners}", "marker-start": place, "marker-mid": place, "marker-end": place}
            | {"style": "fill: none; stroke: none"},
        )

    def _marker(self, name: str, link: str, style: str) -> Element:
        shape = self._shapes[link]
        unnamed = {key: value for key, value in shape.attrib.items() if key != "id"}
        whole = {"id": name, "overflow": "visible", "markerUnits": "userSpaceOnUse", "style": style}
        marker = Element(f"{_SVG}marker", whole)
        marker.append(Element(shape.tag, unnamed))
        return marker


def _joined(parent: Element, markers: _Markers) -> Iterator[Element]:
    """Yield the children; neighbours that look the same are drawn by one path or put into one group."""
    for (tag, link, clip, style), run in groupby(parent, key=_looks):
        children = list(run)
        if len(children) < _FEWEST:
            yield from children
        elif tag == f"{_SVG}use" and link and not clip:
            yield from markers.path(children)
        elif tag == f"{_SVG}path" and style and not _OPACITY.search(style):
            yield _group(children, {"clip-path": clip, "style": style} if clip else {"style": style})
        else:
            yield from children


def _looks(element: Element) -> tuple[str, str, str, str]:
    return element.tag, element.get(_LINK, ""), element.get("clip-path", ""), element.get("style", "")


def _group(children: list[Element], looks: dict[str, str]) -> Element:
    """Return a group that holds what its children share."""
    group = Element(f"{_SVG}g", looks)
    for child in children:
        for key in looks:
            del child.attrib[key]
        group.append(child)
    return group
