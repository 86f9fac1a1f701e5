"""Warm-up: exercise until the drift at a reference pose is small."""
