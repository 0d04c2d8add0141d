"""A camera's response read off two pictures of one exposure: linear light and what it stored."""
