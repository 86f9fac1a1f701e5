"""Procedures of serial arms with a laser tracker, an optical CMM or a ballbar."""
