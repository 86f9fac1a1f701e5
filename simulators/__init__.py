"""The physical bench (the truth) and servers that wear the instruments' protocols."""
