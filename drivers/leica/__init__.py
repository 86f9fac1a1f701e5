"""Leica laser trackers behind an emScon server."""
