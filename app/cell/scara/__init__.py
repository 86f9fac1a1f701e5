"""What only a cell with a SCARA and its interferometer has."""
