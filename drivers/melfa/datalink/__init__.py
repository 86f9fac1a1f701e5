"""Motion through via points by a program that runs in the controller."""
