"""What is kept of a calibration: its LUTs as one set, and the record that stands beside them."""
