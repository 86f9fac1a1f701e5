"""What runs of the SCARA have found by themselves."""
