"""Motion resolution and backlash of joints, and the Cartesian resolution: an arm is stepped and recorded."""
