"""`facecrf doctor`: what a report of a problem should tell."""

from __future__ import annotations

import platform

import click

from facecrf_ocio.cli.terminal import DONE, FAILED, ending_well


@click.command()
@ending_well
def doctor() -> int:
    """Tell versions, models and readable files, to be put into a report of a problem.

    Exit code 1 if something that ships is not as it was made.
    """
    from facecrf_ocio.files.versions import versions
    from facecrf_ocio.photo.readable import readable_kinds

    found = versions()
    for name, version in found.items():
        click.echo(f"{name:<21}{version}")
    click.echo(f"{'system':<21}{platform.platform()}, {platform.machine()}")
    profile = ".".join(found.get("OpenColorIO", "?").split(".")[:2])
    click.echo(f"{'OCIO configs':<21}up to profile {profile}")
    kinds = readable_kinds()
    click.echo(f"{'reads':<21}{', '.join(name for name, can in kinds if can)}")
    lacking = [name for name, can in kinds if not can]
    click.echo(f"{'does not read':<21}{', '.join(lacking) or 'nothing that it could'}")
    if "HEIC or AVIF" in lacking:
        click.echo(" " * 21 + "(HEIC and AVIF: pip install 'facecrf-ocio[heif]')")
    return _tell_models()


def _tell_models() -> int:
    from facecrf_ocio.errors import FaceCRFError
    from facecrf_ocio.face.networks import MODELS, model_path
    from facecrf_ocio.files.content import sha256_of

    code = DONE
    listed = (MODELS / "SHA256SUMS").read_text(encoding="ascii").split()
    for file in listed[1::2]:
        try:
            said = f"as it ships, SHA-256 {sha256_of(model_path(file))[:16]}"
        except FaceCRFError as error:
            said, code = str(error), FAILED
        click.echo(f"{'model':<21}{file}: {said}")
    click.echo(f"{'to report':<21}all of the above, the command, and its last lines")
    return code
