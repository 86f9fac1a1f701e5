"""A cell file with other reflectors; everything else, comments included, stays as it is."""

from pathlib import Path

from catseye.app.cell.rewriting import CommentsLostError, rewritten
from catseye.app.errors import ConfigError
from catseye.app.files.documents import parse_toml, read_text


def with_reflector_tables(path: Path, reflectors: list[tuple[str, float, float, float]]) -> str:
    """Return the text of a cell file with its [[reflector]] tables replaced.

    Args:
        path: the cell file; it has passed every check.
        reflectors: name, x and y in mm, direction of the axis in deg.

    Raises:
        ConfigError: the file cannot be changed in place.
    """
    text = read_text(path)
    tables = [dict(zip(("name", "x_mm", "y_mm", "facing_deg"), values, strict=True)) for values in reflectors]
    try:
        return rewritten(text, {**parse_toml(text, str(path)), "reflector": tables})
    except CommentsLostError as error:
        raise ConfigError(f"{path}: {error}; write each of its tables in one piece") from error
