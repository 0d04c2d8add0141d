"""The `facecrf` command: one file a command."""
