"""What a robot, an interferometer, an air sensor, a tracker and an input/output block are.

Protocols, value types, the clock, errors and poses: all that the engine and the procedures know of instruments.
Standard library only. A driver class subclasses its role, declares what it is able to do, and registers under the
entry point group `catseye.drivers`.
"""
