"""Settings refuse what they may not be."""

from __future__ import annotations

import re
from dataclasses import FrozenInstanceError, fields, replace
from pathlib import Path

import pytest

import facecrf_ocio
from facecrf_ocio.errors import SettingsError
from facecrf_ocio.settings import FaceSettings, JointSettings, PublishedSettings, Settings

PACKAGE = Path(facecrf_ocio.__file__).parent


def test_defaults_are_the_paper_s_where_it_prints_them():
    settings = Settings()
    assert (settings.pigment_weight, settings.monotonicity_weight) == (30000.0, 1000.0)
    assert settings.hue_half_width == 18.0
    assert (settings.value_low, settings.value_high) == (0.25, 0.75)
    assert (settings.gradient_low, settings.gradient_high) == (0.10, 0.95)
    assert not settings.shared_curve


@pytest.mark.parametrize(
    ("wrong", "text"),
    [
        ({"value_low": 0.8}, "value_low must be below value_high"),
        ({"gradient_low": 0.95}, "gradient_low must be below gradient_high"),
        ({"value_high": 1.5}, r"value_high must lie in \[0, 1\]"),
        ({"min_face_score": -0.1}, r"min_face_score must lie in \[0, 1\]"),
        ({"gradient_high": float("nan")}, r"gradient_high must lie in \[0, 1\]"),
    ],
)
def test_impossible_settings_are_refused(wrong, text):
    with pytest.raises(SettingsError, match=text):
        Settings(**wrong)


@pytest.mark.parametrize(
    "name", [f.name for f in fields(Settings) if not isinstance(f.default, bool)]
)
@pytest.mark.parametrize("value", [-1, float("nan")])
def test_no_number_may_be_negative_or_nan(name, value):
    with pytest.raises(SettingsError, match=name):
        Settings(**{name: value})


@pytest.mark.parametrize("holder", [FaceSettings, JointSettings, PublishedSettings])
def test_every_setting_is_documented_where_it_stands(holder):
    for name in holder.__annotations__:
        assert name in (holder.__doc__ or "")


# What each part of the package reads, by the name of its argument.
READ = {
    FaceSettings: ("face", "joint/statistics.py", "calibrate.py"),
    JointSettings: ("joint", "calibrate.py"),
    PublishedSettings: ("published",),
}


@pytest.mark.parametrize("holder", READ)
def test_every_setting_is_read_by_the_part_that_holds_it(holder):
    places = [PACKAGE / place for place in READ[holder]]
    files = [f for p in places for f in ([p] if p.suffix else p.glob("*.py"))]
    text = "".join(file.read_text(encoding="utf-8") for file in files)
    read = {f"settings.{name}" for name in holder.__annotations__}
    assert {name for name in read if not re.search(rf"\b{name}\b", text)} == set()


def test_no_part_can_be_told_what_is_another_s():
    names = [set(holder.__annotations__) for holder in READ]
    assert sum(map(len, names)) == len(set.union(*names)) == len(fields(Settings))


def test_settings_do_not_change():
    settings = Settings()
    with pytest.raises(FrozenInstanceError):
        settings.min_pairs = 1  # type: ignore[misc]
    assert replace(settings, min_pairs=1).min_pairs == 1
    assert settings.min_pairs != 1
