"""What tells wrong pictures is learned from what the estimator measures in them."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from face_photos import grace_hopper
from PIL import Image

from facecrf_ocio import Photo
from facecrf_ocio.face.detect import find_faces
from facecrf_ocio.joint import face_parts, few_levels, gather
from facecrf_ocio.joint.face_parts import ORDERS, FaceColors
from facecrf_ocio.settings import JointSettings
from facecrf_ocio.training.__main__ import main
from facecrf_ocio.training.count_wrong import count
from facecrf_ocio.training.made_wrong import (
    AS_IT_IS,
    LEVELS,
    LIGHTS,
    FaceLight,
    inverted,
    ordinary,
    posters,
    with_grain,
)
from facecrf_ocio.training.plan import Data
from facecrf_ocio.training.regressions import first_of, two_classes
from facecrf_ocio.training.wrong_pictures import SHIPPED, in_orders, told_by, told_by_heads

CODES = np.rint(grace_hopper() * 255).astype(np.uint8)


def drawn() -> np.random.Generator:
    return np.random.default_rng(0)


@pytest.fixture(scope="module")
def hopper():
    return told_by(CODES, drawn(), with_levels=True)


MADE = {
    "as it is": CODES,
    "luma inverted": next(inverted(CODES, drawn())),
    **{what: CODES[..., list(order)] for order, what in ORDERS.items()},
}


@pytest.mark.parametrize("name", MADE)
def test_weights_say_of_what_is_learned_from_what_the_estimator_says(name: str) -> None:
    codes = np.ascontiguousarray(MADE[name])
    told = told_by(codes, drawn(), with_levels=False)
    said = gather(Photo.of_codes(codes)).doubt
    assert told.upright @ face_parts.BRIGHT > face_parts.INVERTED or name != "luma inverted"
    assert (told.upright @ face_parts.BRIGHT > face_parts.INVERTED) == ("inverted" in said)
    scores = in_orders(told.colors) @ face_parts.COLORED
    assert (scores[1:].max() - scores[0] > face_parts.SWAPPED) == ("swapped" in said)


def test_levels_are_looked_for_in_the_pixels_that_the_estimator_looks_at(hopper) -> None:
    (face,) = find_faces(CODES, JointSettings()).faces
    seen = few_levels.face_codes(CODES, face.box_xy)
    kind, told = hopper.ordinary[0]
    assert kind == AS_IT_IS
    np.testing.assert_array_equal(told, few_levels.grain_told(seen))
    for (levels, found), (_, made) in zip(hopper.posters, posters_again(), strict=True):
        says = few_levels.has_grainy_levels(few_levels.face_codes(made, face.box_xy))
        assert levels in LEVELS
        assert (found @ few_levels.GRAINY > few_levels.MOST_GRAINY) == says


def posters_again():
    """Of the same draws: inverted and ordinary ones come before them."""
    generator = drawn()
    for before in (inverted, ordinary):
        assert list(before(CODES, generator))
    return list(posters(CODES, generator))


def test_a_light_treats_all_channels_alike() -> None:
    one = FaceColors(np.log(drawn().uniform(20, 200, (5, 3))), np.cov(drawn().normal(size=(3, 40))))
    plain = LIGHTS[AS_IT_IS].on(one, drawn())
    np.testing.assert_allclose(plain.middle, one.middle)
    np.testing.assert_allclose(plain.spread, one.spread)
    gray = FaceLight(saturation=(0.5, 0.9), evened=(1.0, 1.0))
    for order in ORDERS:
        lit, swapped = gray.on(one, drawn()).in_order(order), gray.on(one.in_order(order), drawn())
        np.testing.assert_allclose(lit.middle, swapped.middle)
        np.testing.assert_allclose(lit.spread, swapped.spread)
    np.testing.assert_allclose(np.ptp(gray.on(one, drawn()).middle[0]), 0.0, atol=1e-9)


def test_grain_has_the_deviation_that_was_drawn() -> None:
    gray = np.full((200, 200, 3), 128, np.uint8)
    for seed in range(8):
        grain = with_grain(gray, np.random.default_rng(seed)).astype(float) - 128
        assert min(abs(grain.std() / deviation - 1) for deviation in (3, 6, 9)) < 0.25


def test_two_classes_find_the_odds_that_made_them() -> None:
    generator, weights = drawn(), np.array([2.0, -1.0, 0.5])
    rows = generator.normal(1.0, [1.0, 3.0, 0.2], (40_000, 3))
    yes = generator.random(len(rows)) < 1.0 / (1.0 + np.exp(-(rows @ weights - 1.0)))
    found, constant = two_classes(rows[~yes], rows[yes], 1.0, balanced=False)
    np.testing.assert_allclose(found, weights, atol=0.15)
    assert constant == pytest.approx(-1.0, abs=0.2)


def test_the_first_of_some_is_told_by_the_odds_that_made_it() -> None:
    generator, weights = drawn(), np.array([1.0, -2.0])
    rows = generator.normal(size=(20_000, 4, 2))
    best = (rows @ weights + generator.gumbel(size=(20_000, 4))).argmax(axis=1)
    others = [np.delete(row, at, axis=0) for row, at in zip(rows, best, strict=True)]
    first = np.concatenate([rows[np.arange(len(rows)), best][:, None], np.array(others)], axis=1)
    np.testing.assert_allclose(first_of(first, 1.0), weights, atol=0.1)


def test_counts_are_of_all_that_was_made(hopper) -> None:
    counts = count([hopper, hopper], SHIPPED, seed=0)
    assert counts["not inverted"] == (0, 2)
    assert counts["inverted"] == (4, 4)
    assert counts["as it is, not swapped"] == (0, 2)
    assert counts["as it is, red and blue exchanged"] == (2, 2)
    assert counts["as it is, each channel in another's place"] == (4, 4)
    assert counts["photos as it is"] == (0, 2)
    assert sum(counts[f"posters of {n} levels"][1] for n in LEVELS) == 6


def run(*arguments: object):
    return CliRunner().invoke(main, ["wrong-pictures", *map(str, arguments)])


def test_the_command_prints_weights_and_what_they_tell(tmp_path: Path) -> None:
    for name in ("a", "b"):
        Image.fromarray(CODES if name == "a" else CODES[:, ::-1]).save(tmp_path / f"{name}.png")
    (tmp_path / "c.jpg").write_bytes(b"no photo")
    result = run(tmp_path, "--held-out", tmp_path)
    assert result.exit_code == 0, result.output
    lines = result.output.splitlines()
    assert lines[0] == "2 portraits, 0 photos of rendered heads:"
    assert [line.split(" = ")[0] for line in lines[1:5]] == [
        *("BRIGHT", "INVERTED", "COLORED"),
        "GRAINY, MOST_GRAINY",
    ]
    assert lines[1].count(",") == 7
    assert lines[3].count(",") == 13
    assert "2 other portraits" in lines[5]
    assert "|inverted|4|" in "".join(result.output.split())
    assert run(tmp_path).output.splitlines() == lines[:5]  # the same again


def test_what_is_wrong_with_a_folder_is_told_in_one_line(tmp_path: Path) -> None:
    def told(*arguments: object) -> str:
        result = run(*arguments)
        assert isinstance(result.exception, SystemExit)
        return result.output.splitlines()[-1]

    assert "holds no JPEG or PNG; give a folder of portraits" in told(tmp_path)
    assert "does not exist" in told(tmp_path / "gone")
    Image.new("RGB", (64, 64), (90, 120, 80)).save(tmp_path / "a.png")
    assert "none of 1 photo shows a whole face in color; give photos of faces" in told(tmp_path)
    Image.fromarray(CODES).save(tmp_path / "a.png")
    assert "holds no faces/rendered/img/train_*" in told(tmp_path, "--data", tmp_path)


def test_rendered_heads_are_learned_from_too(chart_curves: Path) -> None:
    default = Path(__file__).resolve().parents[2] / "shared" / "data"
    data = Data(Path(os.environ.get("FACECRF_DATA", default)), chart_curves)
    if not data.heads():
        pytest.skip(f"no rendered heads in {data.root}; set FACECRF_DATA")
    for told in told_by_heads(data, count=2):
        assert told.upright @ face_parts.BRIGHT < face_parts.INVERTED
        assert told.posters == ()
