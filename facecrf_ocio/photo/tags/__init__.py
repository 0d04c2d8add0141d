"""What a file says of its picture: camera, color, curve, edits."""
