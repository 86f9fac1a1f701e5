"""Walk-throughs."""
