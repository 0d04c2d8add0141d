"""Cameras whose response was measured: those that ship, and those that users add."""
