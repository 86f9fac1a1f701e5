"""What only a SCARA's bench is served with."""
