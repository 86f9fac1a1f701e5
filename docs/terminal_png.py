"""A screen of the terminal user interface as a PNG, drawn cell by cell."""

from pathlib import Path
from typing import Any, Final

from matplotlib import get_data_path
from PIL import Image, ImageDraw, ImageFont
from rich.cells import cell_len
from rich.color import Color
from rich.style import Style
from textual.app import App

_WIDTH: Final = 9
_HEIGHT: Final = 18
_DOT: Final = 1.6
_DOTS: Final = ((0, 0, 1), (1, 0, 2), (2, 0, 4), (0, 1, 8), (1, 1, 16), (2, 1, 32), (3, 0, 64), (3, 1, 128))
"""Row, column and bit of each dot of a braille cell."""

_FONTS: Final = {
    bold: ImageFont.truetype(f"{get_data_path()}/fonts/ttf/DejaVuSansMono{'-Bold' if bold else ''}.ttf", 15)
    for bold in (False, True)
}

Shade = tuple[int, int, int]


def write_png(app: App[Any], path: Path) -> None:
    """Write what an app shows now."""
    lines = app.screen._compositor.render_strips()  # noqa: SLF001  # Textual has no public way to read the screen
    picture = Image.new("RGB", (app.size.width * _WIDTH, len(lines) * _HEIGHT))
    pen = ImageDraw.Draw(picture)
    for row, line in enumerate(lines):
        column = 0
        for piece in line:
            style = piece.style or Style()
            for letter in piece.text:
                _draw_cell(pen, column, row, letter, style)
                column += max(cell_len(letter), 1)
    picture.save(path)


def _draw_cell(pen: ImageDraw.ImageDraw, column: int, row: int, letter: str, style: Style) -> None:
    front, back = _shade(style.color, (220, 220, 220)), _shade(style.bgcolor, (0, 0, 0))
    if style.reverse:
        front, back = back, front
    if style.dim:
        front = (front[0] + back[0]) // 2, (front[1] + back[1]) // 2, (front[2] + back[2]) // 2
    x, y = column * _WIDTH, row * _HEIGHT
    pen.rectangle((x, y, x + max(cell_len(letter), 1) * _WIDTH - 1, y + _HEIGHT - 1), fill=back)
    dots = ord(letter) - 0x2800
    if 0 <= dots < 0x100:
        # Fonts draw braille with gaps between the cells; a terminal does not.
        for down, across, bit in _DOTS:
            if dots & bit:
                left, top = x + 2.0 + 4.5 * across, y + 2.0 + 4.5 * down
                pen.rectangle((left, top, left + _DOT, top + _DOT), fill=front)
    elif letter != " ":
        pen.text((x, y), letter, font=_FONTS[bool(style.bold)], fill=front)


def _shade(colour: Color | None, default: Shade) -> Shade:
    if colour is None or colour.is_default:
        return default
    red, green, blue = colour.get_truecolor()
    return red, green, blue
