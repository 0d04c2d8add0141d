"""What a photo can tell about its response: one file, one cue."""
