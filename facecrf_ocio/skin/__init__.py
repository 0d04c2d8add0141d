"""From a face to its single-pigment gradients (sec. 5)."""
