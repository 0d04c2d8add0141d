"""Thousands of photos, unattended: every one either calibrated or listed with the reason.

The straight line from here: `walk.py` names the photos, `run.py` decides what is to do and records
it in the manifest (`manifest.py`), `pool.py` keeps worker processes that cost one photo each when
they die, `worker.py` does the work on one photo, and `verify.py` checks the outputs afterward.
"""
