"""Writing what was found: LUT files for OpenColorIO, and the sidecar that records how."""

from facecrf_ocio.export.lut import FORMATS, write_lut
from facecrf_ocio.export.outputs import (
    DEFAULT_FORMATS,
    output_paths,
    require_distinct_names,
    require_outputs_free,
    write_outputs,
)
from facecrf_ocio.export.sidecar import Sidecar, read_sidecar, write_sidecar
from facecrf_ocio.export.verify import verify_lut

__all__ = [
    "DEFAULT_FORMATS",
    "FORMATS",
    "Sidecar",
    "output_paths",
    "read_sidecar",
    "require_distinct_names",
    "require_outputs_free",
    "verify_lut",
    "write_lut",
    "write_outputs",
    "write_sidecar",
]
