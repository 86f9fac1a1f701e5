"""Driving a plan slowly before it is driven in earnest, and knowing what was walked."""
