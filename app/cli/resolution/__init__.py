"""Commands about motion resolution."""
