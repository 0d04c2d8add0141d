"""How results show themselves where Python is used by hand."""
