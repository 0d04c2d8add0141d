"""How the shipped weights of `joint` came about; needs the extra `train` (PyTorch) and the data."""
