"""A camera's response from a color chart in the photo."""
