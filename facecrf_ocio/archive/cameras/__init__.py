"""Photos of one camera: brackets, and one curve that their evidence gives together."""
