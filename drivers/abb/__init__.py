"""ABB: IRC5 controllers by Robot Web Services 1.0 (sheet `kuka_abb_robodk`, part B1)."""
