"""Thousands of photos, unattended: every one either calibrated or listed with the reason.

The straight line from here: `walk.py` names the photos, `run.py` decides what is to do and records
it in the `manifest`, `work/processes.py` keeps worker processes that cost one photo each when they
die, `work/one_photo.py` does the work on one photo, and `check_outputs.py` checks the outputs
afterward.
"""
