"""Procedures of serial arms with a tracker."""
