"""Sizes as people read them."""


def bytes_text(size: float) -> str:
    """Return a size: 12 GB, 340 MB."""
    for unit, factor in (("TB", 1e12), ("GB", 1e9), ("MB", 1e6)):
        if size >= factor:
            value = size / factor
            return f"{value:.0f} {unit}" if value >= 10 else f"{value:.1f} {unit}"
    return f"{size / 1e3:.0f} kB"
