"""A compacted drawing shows the same markers and lines at the same places with the same looks."""

import io
import re
from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib.figure import Figure

from catseye.app.render.compact_svg import compact
from catseye.calibration.core.types import Floats

SVG = "{http://www.w3.org/2000/svg}"
XY = np.random.default_rng(4).uniform(-50.0, 50.0, (200, 2))


def drawn(marker: str, alpha: float) -> tuple[str, Floats]:
    """Return the text of a drawing with 200 markers and the places where they have to stand, in points."""
    figure = Figure(figsize=(4, 3))
    axes = figure.subplots()
    axes.plot(*XY.T, marker, color="#123456", alpha=alpha, markeredgecolor="#abcdef", label="them")
    axes.errorbar(XY[:, 0], XY[:, 1], 3.0, fmt="none", ecolor="#00aa00", elinewidth=0.7)
    figure.legend()
    buffer = io.StringIO()
    figure.savefig(buffer, format="svg")
    places = axes.transData.transform(XY) * 72.0 / figure.dpi
    places[:, 1] = 72.0 * 3.0 - places[:, 1]
    return buffer.getvalue(), places


def corners(path: ElementTree.Element) -> Floats:
    return np.array(re.findall(r"-?[\d.]+", path.attrib["d"]), dtype=np.float64).reshape(-1, 2)


@pytest.mark.parametrize(("marker", "alpha"), [("o", 1.0), (".", 0.5), ("x", 1.0)])
def test_every_marker_stands_where_the_data_are(marker: str, alpha: float) -> None:
    text, places = drawn(marker, alpha)
    root = ElementTree.fromstring(compact(text))
    paths = [path for path in root.iter(f"{SVG}path") if "marker-start" in path.attrib]
    assert len(paths) == 1
    assert np.abs(corners(paths[0]) - places).max() <= 0.0051
    name = paths[0].attrib["marker-mid"]
    assert name == paths[0].attrib["marker-start"] == paths[0].attrib["marker-end"]
    shape = next(one for one in root.iter(f"{SVG}marker") if f"url(#{one.get('id')})" == name)
    assert "#abcdef" in ElementTree.tostring(shape, encoding="unicode")
    assert ("opacity: 0.5" in shape.attrib["style"]) == (alpha < 1.0)


def test_lines_keep_their_looks_and_their_ends() -> None:
    text, places = drawn("o", 1.0)
    root = ElementTree.fromstring(compact(text))
    groups = [group for group in root.iter(f"{SVG}g") if "#00aa00" in group.get("style", "")]
    assert len(groups) == 1
    assert "clip-path" in groups[0].attrib
    middles = np.array([corners(path).mean(axis=0) for path in groups[0]])
    assert np.abs(middles - places).max() <= 0.0051


def test_compacting_shortens_the_text_and_keeps_references() -> None:
    text, _ = drawn("o", 1.0)
    short = compact(text)
    names = set(re.findall(r' id="([^"]*)"', short))
    assert set(re.findall(r'(?:url\(|href=")#([^)"]*)', short)) <= names
    assert len(short) < 0.4 * len(text)


def test_neighbours_that_blend_as_a_whole_stay_alone() -> None:
    path = '<path d="M 0.123456 0.0 L 1.0 1.0" style="opacity: 0.5; fill: none"/>'
    short = compact(f'<svg xmlns="http://www.w3.org/2000/svg">{3 * path}</svg>')
    assert short.count("opacity") == 3
    assert short.count("M0.12 0L1 1") == 3
