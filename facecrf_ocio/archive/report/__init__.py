"""The report of an archive: one HTML file that needs nothing but a browser."""

from __future__ import annotations

from facecrf_ocio.archive.report.write_report import Written, write_report

__all__ = ["Written", "write_report"]
