"""What is shown of a SCARA's bench alone."""
