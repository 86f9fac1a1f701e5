"""Lasertex HPI-3D and Status Pro µLine F1."""
