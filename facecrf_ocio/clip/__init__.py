"""One curve of a clip: frames chosen over time, evidence pooled, drift told."""
