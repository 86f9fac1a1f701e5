"""What the screens show of motion resolution: staircases, step errors, least steps."""
