"""Questions and messages above a screen."""
