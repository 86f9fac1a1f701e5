"""Kinematics of any serial arm: frames, bodies, and the ways that these sweep."""
