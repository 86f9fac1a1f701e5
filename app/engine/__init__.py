"""The engine: states, stop ladder, context of a procedure, run host."""
