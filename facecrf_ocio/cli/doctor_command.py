"""`facecrf doctor`: what a report of a problem should tell."""

from __future__ import annotations

import platform

import click

from facecrf_ocio.cli.terminal import DONE, FAILED, ending_well, say

_COLUMN = 21  # letters: more than any name has


@click.command()
@ending_well
def doctor() -> int:
    """Tell versions, models and readable files, to be put into a report of a problem.

    Exit code 1 if something that ships is not as it was made.
    """
    from facecrf_ocio.files.versions import versions
    from facecrf_ocio.photo.containers.readable import readable_kinds

    found = versions()
    for name, version in found.items():
        _tell(name, version)
    _tell("system", f"{platform.platform()}, {platform.machine()}")
    profile = ".".join(found.get("OpenColorIO", "?").split(".")[:2])
    _tell("OCIO configs", f"up to profile {profile}")
    kinds = readable_kinds()
    _tell("reads", ", ".join(name for name, can in kinds if can))
    lacking = [name for name, can in kinds if not can]
    _tell("does not read", ", ".join(lacking) or "nothing that it could")
    if "HEIC or AVIF" in lacking:
        _tell("", "(HEIC and AVIF: pip install 'facecrf-ocio[heif]')")
    return _tell_models()


def _tell(name: str, text: str) -> None:
    say(f"{name:<{_COLUMN}}{text}", indent=_COLUMN)


def _tell_models() -> int:
    from facecrf_ocio.errors import FaceCRFError
    from facecrf_ocio.face.networks import MODELS, model_file
    from facecrf_ocio.files.content import sha256_of

    code = DONE
    listed = (MODELS / "SHA256SUMS").read_text(encoding="ascii").split()
    for file in listed[1::2]:
        try:
            with model_file(file) as path:
                said = f"as it ships, SHA-256 {sha256_of(path)[:16]}"
        except FaceCRFError as error:
            said, code = str(error), FAILED
        _tell("model", f"{file}: {said}")
    _tell("to report", "all of the above, the command, and its last lines")
    return code
