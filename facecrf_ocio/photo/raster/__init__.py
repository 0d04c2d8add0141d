"""Pixels in memory, apart from any file."""
