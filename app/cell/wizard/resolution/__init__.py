"""Questions about the motion resolution of an arm."""
