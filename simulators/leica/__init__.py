"""Emulated Leica tracker behind an emScon server."""
