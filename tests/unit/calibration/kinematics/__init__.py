"""Tests of the kinematics of any arm."""
