"""Walk-throughs: a plan driven slowly, as long as somebody feeds."""
