"""The manifest of an archive: all that is known of every photo, in SQLite."""
