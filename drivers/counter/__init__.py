"""Length counters that speak lines of text, described by a profile."""
