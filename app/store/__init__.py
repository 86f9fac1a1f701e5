"""The run store: one directory a run, an acknowledged record survives the process."""
