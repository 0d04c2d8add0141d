"""RGB primaries, white points and working spaces."""
