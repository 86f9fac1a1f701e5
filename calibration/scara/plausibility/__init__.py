"""Whether an identified arm can be the one that was measured, and which mistake explains one that cannot."""
