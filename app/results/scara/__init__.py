"""Analyses of a SCARA measured by open-loop tracking, one report function each."""
