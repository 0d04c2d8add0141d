"""One curve to one LUT file, in any format, read back through OpenColorIO and compared."""
