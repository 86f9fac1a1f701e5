"""What a run says about itself: how it was measured, by what, and what it can be traced to."""
