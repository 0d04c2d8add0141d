"""The work on one photo, and the processes or machines that do it."""
