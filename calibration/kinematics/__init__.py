"""Kinematics of arms: the planar SCARA, serial chains, bodies and the ways that these sweep."""
