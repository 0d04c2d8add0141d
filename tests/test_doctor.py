"""`facecrf doctor` tells what a report needs, and notices a changed model."""

from __future__ import annotations

from click.testing import CliRunner

from facecrf_ocio import __version__
from facecrf_ocio.cli.facecrf import main
from facecrf_ocio.errors import FaceCRFError
from facecrf_ocio.face import networks
from facecrf_ocio.face.networks import MODELS


def told():
    result = CliRunner().invoke(main, ["doctor"])
    return result.exit_code, result.output


def test_versions_models_and_formats_are_told():
    code, text = told()
    assert code == 0
    assert f"facecrf_ocio         {__version__}" in text
    assert "JPEG, PNG" in text
    assert "camera raw" in text
    listed = (MODELS / "SHA256SUMS").read_text(encoding="ascii").split()
    assert all(digest[:16] in text for digest in listed[::2])
    assert all(name in text for name in listed[1::2])


def test_a_model_that_was_changed_ends_with_an_error(monkeypatch):
    def broken(file):
        raise FaceCRFError(f"{file}: is not the model that ships; install facecrf-ocio again")

    monkeypatch.setattr(networks, "model_file", broken)
    code, text = told()
    assert code == 1
    assert "install facecrf-ocio again" in text
