"""A SCARA that carries the interferometer: its motion, its errors, and what it truly is."""
