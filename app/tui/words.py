"""Numbers as people read them."""

from catseye.app.cli.progress import duration_text as whole_duration_text


def duration_text(duration_s: float) -> str:
    """Return a duration: 4.2 s, 3 min 05 s, 2 h 07 min."""
    return f"{duration_s:.1f} s" if duration_s < 10.0 else whole_duration_text(duration_s)


def bytes_text(size: float) -> str:
    """Return a size: 12 GB, 340 MB."""
    for unit, factor in (("TB", 1e12), ("GB", 1e9), ("MB", 1e6)):
        if size >= factor:
            value = size / factor
            return f"{value:.0f} {unit}" if value >= 10 else f"{value:.1f} {unit}"
    return f"{size / 1e3:.0f} kB"
