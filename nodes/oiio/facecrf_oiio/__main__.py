"""`python -m facecrf_oiio` is `facecrf-oiio`."""

from facecrf_oiio.command import main

main()
