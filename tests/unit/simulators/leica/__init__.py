"""Tests of the emulated Leica tracker."""
