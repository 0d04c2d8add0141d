"""What results mean, in words: made of their fields where they are shown, and in one place."""
