"""How fast it is, beside what no program can do without: the decoder, and the encoder."""
