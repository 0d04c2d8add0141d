"""Wrong arguments of public functions: one of our errors, in a line that says what to give."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import facecrf_ocio as public
from facecrf_ocio import FaceCRFError, InverseCRF, Photo, Primaries, Settings, SettingsError

CODES = np.linspace(0.0, 1.0, 64)
CURVE = InverseCRF(CODES, np.tile(CODES**2, (3, 1)))
PHOTO = Photo(np.full((12, 16, 3), 0.5, np.float32), bit_depth=8)

WRONG = (
    *(None, 7, 1.5, float("nan"), True, "", "nonsense", "a\0b", b"bytes", "\udcff", object(), int),
    *([], (), {}, set(), [None], ["x"], {"a": 1}, 1 + 2j, np.float32(1), Path("nope")),
    *(np.zeros(0), np.zeros((0, 0, 3)), np.zeros((2, 2)), np.array(None), np.array("x")),
    *(np.zeros((2, 2, 3), complex), np.zeros((2, 2, 3), object), np.full((2, 2, 3), np.nan)),
)


def calls(folder):
    """Each function of one argument, by what it is about."""

    def exr(**options):
        return public.linearize_photo(PHOTO, folder / "a.exr", estimator="srgb", **options)

    def lut(**options):
        return public.write_lut(CURVE, folder / "a.clf", **options)

    two = [PHOTO, PHOTO]
    by_name = {
        "read_photo": public.read_photo,
        "calibrate": lambda x: public.calibrate(x, estimator="srgb"),
        "calibrate_together": public.calibrate_together,
        "one of calibrate_together": lambda x: public.calibrate_together([x]),
        "calibrate_pair": public.calibrate_pair,
        "second of calibrate_pair": lambda x: public.calibrate_pair(PHOTO, x),
        "calibrate_bracket": lambda x: public.calibrate_bracket(x, [0, 1]),
        "one of calibrate_bracket": lambda x: public.calibrate_bracket([PHOTO, x], [0, 1]),
        "stops": lambda x: public.calibrate_bracket(two, x),
        "one of stops": lambda x: public.calibrate_bracket(two, [0, x]),
        "center_only": lambda x: public.calibrate_bracket(two, [0, 1], center_only=x),
        "linearize_photo": lambda x: public.linearize_photo(x, folder / "b.exr"),
        "exr": lambda x: public.linearize_photo(PHOTO, x),
        "write_lut": lambda x: public.write_lut(x, folder / "a.spi1d"),
        "path": lambda x: public.write_lut(CURVE, x),
        "read_curve": public.read_curve,
        "gather": public.gather,
        "conclude": public.conclude,
        "misfit": lambda x: public.misfit(x, x),
        "InverseCRF.encoded": lambda x: InverseCRF(x, CURVE.linear),
        "InverseCRF.linear": lambda x: InverseCRF(CURVE.encoded, x),
        "linearize": CURVE.linearize,
        "encode": CURVE.encode,
        "Photo": Photo,
        "xy": lambda x: Photo(
            PHOTO.encoded, primaries=Primaries("", x, *(((0.3, 0.3),) * 3), source="")
        ),
    }
    for name in ("estimator", "fallback", "prior", "settings", "model", "evidence"):
        by_name[f"calibrate, {name}"] = lambda x, name=name: public.calibrate(PHOTO, **{name: x})
    for name in ("space", "exposure", "half", "compression", "overwrite", "uncertainty"):
        by_name[f"linearize_photo, {name}"] = lambda x, name=name: exr(**{name: x})
    for name in ("overwrite", "provenance", "direction", "space", "primaries"):
        by_name[f"write_lut, {name}"] = lambda x, name=name: lut(**{name: x})
    for name in ("scene_linear", "alpha", "primaries", "camera", "path", "edits", "notes"):
        by_name[f"Photo, {name}"] = lambda x, name=name: repr(Photo(PHOTO.encoded, **{name: x}))
    for name in ("face_width", "shared_curve", "value_low", "most_flat", "gradient_high"):
        by_name[f"Settings, {name}"] = lambda x, name=name: Settings(**{name: x})
    return by_name


@pytest.mark.parametrize("what", calls(Path()))
@pytest.mark.filterwarnings("error")
def test_whatever_is_given_no_error_comes_from_inside(tmp_path, monkeypatch, what):
    monkeypatch.chdir(tmp_path)
    call, said = calls(tmp_path)[what], []
    for wrong in WRONG:
        try:
            call(wrong)
        except FaceCRFError as error:
            said.append(str(error))
    assert [line for line in said if "\n" in line] == []
    # What is left are values that may be meant: None, numbers, empty texts and arrays.
    assert len(said) > 0.6 * len(WRONG)


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (
            lambda: public.linearize_photo(PHOTO, "a.exr", compression=None),
            "compression is given as NoneType; give str",
        ),
        (
            lambda: public.linearize_photo(PHOTO, "a.exr", overwrite="no"),
            "overwrite is given as str; give bool",
        ),
        (lambda: public.read_photo(None), "path is given as NoneType; give str or PathLike"),
        (lambda: public.read_photo("a\0b"), "give a name without a null character"),
        (
            lambda: public.calibrate_together("a.jpg"),
            "photos is given as str; give Iterable",
        ),
        (
            lambda: public.conclude([None]),
            "a part of evidence is given as NoneType; give PhotoEvidence",
        ),
        (
            lambda: public.calibrate_bracket([PHOTO, PHOTO], [0.0, 1.0, 2.0]),
            "3 exposures for 2 photos; give one for each",
        ),
        (
            lambda: public.calibrate_bracket([PHOTO, PHOTO], [0.0, float("inf")]),
            "an exposure is not finite; give stops",
        ),
        (lambda: Photo(PHOTO.encoded, path="a.jpg"), "path is given as str; give PathLike"),
        (lambda: Settings(face_width="160"), "face_width must be int"),
        (lambda: Settings(first_order=1), "first_order must be bool"),
        (lambda: CURVE.encode(np.array([["a", "b", "c"]])), "values, not (1, 3) of <U1"),
    ],
)
def test_the_line_says_what_is_wrong_and_what_to_give(call, said):
    with pytest.raises(SettingsError) as told:
        call()
    assert said in str(told.value)


def test_what_numpy_and_paths_give_is_taken(tmp_path):
    exr = tmp_path / "a.exr"
    options = {"half": np.True_, "exposure": np.float32(0.5), "overwrite": np.False_}
    public.linearize_photo(PHOTO.encoded, exr, estimator="srgb", **options)
    assert public.read_photo(str(exr)).scene_linear
    assert Settings(face_width=np.int64(200), value_low=np.float32(0.25)).face_width == 200


def test_an_option_that_is_none_is_told_before_the_photo_is_looked_at(tmp_path):
    with pytest.raises(TypeError, match="unexpected keyword argument 'size'"):
        public.linearize_photo(tmp_path / "missing.jpg", tmp_path / "a.exr", size=3)


def test_brackets_may_be_paths_and_arrays(tmp_path):
    light = np.tile(np.geomspace(0.004, 1.0, 320, dtype=np.float32)[:, None], (240, 1, 3))
    shots = [
        np.rint(CURVE.encode(np.clip(light * 2.0**stop, 0, 1)) * 255).astype(np.uint8)
        for stop in (-2, 0, 2)
    ]
    found = public.calibrate_bracket(shots, (-2, 0, 2)).estimate.curve
    np.testing.assert_allclose(found.linearize([[0.5] * 3]), 0.25, atol=0.02)
