"""Where to put reflectors and which commands to use: the information that a measurement would bring."""
