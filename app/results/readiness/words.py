"""How long ago, as people say it."""


def age_text(age_s: float) -> str:
    """Return an age: just now, 12 min ago, 5 h ago, 3 d ago."""
    if age_s < 90.0:
        return "just now"
    minutes = age_s / 60.0
    if minutes < 90.0:
        return f"{minutes:.0f} min ago"
    hours = minutes / 60.0
    return f"{hours:.0f} h ago" if hours < 36.0 else f"{hours / 24.0:.0f} d ago"
