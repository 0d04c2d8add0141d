"""The response model: which curves there are, and how likely each is (sec. 4)."""
