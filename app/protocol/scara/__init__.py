"""What clients see of a SCARA's bench alone."""
