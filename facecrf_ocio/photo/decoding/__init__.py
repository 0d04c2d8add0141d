"""From a file to code values, by whoever reads its kind."""
