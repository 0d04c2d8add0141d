"""One file, one LUT format."""
