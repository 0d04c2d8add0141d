"""What the bytes of an output depend on besides photo, settings and versions: the processor.

Libraries choose their code by what the processor can do, and other code rounds otherwise. The same
versions give the same bytes on processors that can do the same; on others the last digits differ.
"""

from __future__ import annotations

import platform
import re
from pathlib import Path

# Vector instructions, as Linux names them, for which OpenBLAS, NumPy and OpenCV have own code.
_VECTORS = frozenset(
    (
        *("sse4_2", "avx", "fma", "f16c", "avx2", "avx512f", "avx512cd", "avx512bw", "avx512dq"),
        *("avx512vl", "avx512_vnni", "avx512_vbmi2", "avx512_bf16", "avx512_fp16", "amx_tile"),
        *("asimd", "asimdhp", "asimddp", "asimdfhm", "sve", "sve2", "bf16", "i8mm"),
    )
)


def processor() -> str:
    """The processor's kind, and what it can do that numerical libraries ask for."""
    return f"{platform.machine()} {' '.join(_features())}".strip()


def _features() -> list[str]:
    """Of Linux alone: elsewhere the kind must do."""
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace")
    except OSError:
        return []
    found = re.search(r"^(?:flags|Features)\s*:(.*)$", text, re.MULTILINE)
    return sorted(_VECTORS.intersection(found[1].split())) if found else []
