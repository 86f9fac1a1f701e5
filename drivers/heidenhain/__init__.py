"""Heidenhain ND position displays."""
