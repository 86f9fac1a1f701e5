"""What the screens know of any serial arm: how it stands, and the keys that move its axes."""
