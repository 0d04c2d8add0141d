"""One curve of a clip: frames chosen over time, their evidence together, drift told."""
