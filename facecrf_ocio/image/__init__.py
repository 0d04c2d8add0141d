"""From code values to scene-linear pixels, and on to an image file."""
