"""Linearize OpenImageIO's ImageBufs and files with a LUT."""

from facecrf_oiio.buffer import linearize

__all__ = ["linearize"]
