"""Motion by hand between runs: jogging, and bytes sent to a device's link."""
