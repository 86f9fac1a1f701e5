"""Questions about the cell of a serial arm that a tracker looks at."""
