"""Faces: where they are, their landmarks, and the normal of every pixel."""
