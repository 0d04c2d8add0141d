"""`python -m facecrf_ocio`: the `facecrf` command where its script is not on the path."""

from __future__ import annotations

from facecrf_ocio.cli.facecrf import main

if __name__ == "__main__":
    main(prog_name="facecrf")
