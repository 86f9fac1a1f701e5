"""Where reflectors stand best, and which commands to use."""
