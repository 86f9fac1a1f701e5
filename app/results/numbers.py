"""Numbers as people read them."""


def duration_text(seconds: float, *, whole: bool = False) -> str:
    """Return a duration: 4.2 s, 42 s, 3 min 05 s, 2 h 07 min.

    Args:
        seconds: not negative.
        whole: no tenths below 10 s, for what is redrawn all the time.
    """
    if seconds < 9.95 and not whole:
        return f"{seconds:.1f} s"
    rounded = max(0, round(seconds))
    if rounded < 60:
        return f"{rounded} s"
    minutes, rest = divmod(rounded, 60)
    if minutes < 60:
        return f"{minutes} min {rest:02d} s"
    return f"{minutes // 60} h {minutes % 60:02d} min"
