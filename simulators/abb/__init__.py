"""ABB IRC5: Robot Web Services 1.0 and the program that moves the arm (sheet `kuka_abb_robodk`, part B1)."""
