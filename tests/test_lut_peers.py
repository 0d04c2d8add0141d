"""LUTs and configs that others publish, where a folder of them is named by FACECRF_PEERS.

The documentation's counts are of OpenColorIO's `tests/data`, the CLFs of OpenColorIO-Config-ACES,
colour-science's test resources, and the AgX and filmic configs; none of them is shipped here.
"""

from __future__ import annotations

import os
import shutil
from collections import Counter
from pathlib import Path

import numpy as np
import PyOpenColorIO as ocio  # noqa: N813
import pytest
from config_spaces import lost, read
from lut_files import through_ocio
from photo_files import GRID

from facecrf_ocio.errors import LutError, SettingsError
from facecrf_ocio.image.lut_lookup import lut_lookup
from facecrf_ocio.lut.lint import lint
from facecrf_ocio.lut.usable import why_unusable
from facecrf_ocio.lut.write import write_lut
from facecrf_ocio.ocio_config import write_config
from facecrf_ocio.values import InverseCRF

pytestmark = pytest.mark.slow
EVIDENCE = Path(__file__).parents[1] / "docs" / "evidence" / "luts-of-others.md"
SUFFIXES = {f".{suffix}" for _, suffix in ocio.FileTransform.getFormats()}
GRAY = np.repeat(np.linspace(0, 1, 65, dtype=np.float32)[None, :, None], 3, axis=2)
COLORS = np.random.default_rng(3).random((4, 65, 3), np.float32)
PIXELS = np.ascontiguousarray(np.concatenate([GRAY, COLORS]))
PLAIN = ("applied", "refused by OpenColorIO, told by lint")  # ends that no list need tell
# Published files that lint warns of, and rightly: their tables fall.
TRUE_FINDINGS = {"Demo.csp", "Demo.cube"}


@pytest.fixture(scope="module")
def peers() -> Path:
    folder = os.environ.get("FACECRF_PEERS", "")
    if not folder or not Path(folder).is_dir():
        pytest.skip("no folder of others' LUTs; name one by FACECRF_PEERS")
    return Path(folder)


def files(folder: Path) -> list[Path]:
    return [path for path in sorted(folder.rglob("*")) if path.suffix.lower() in SUFFIXES]


def applied(path: Path) -> str:
    """How a file that OpenColorIO accepts is applied, or why it is refused."""
    how, direction, backward = "applied", None, path.suffix.lower() in (".icc", ".icm", ".pf")
    try:
        lookup = lut_lookup(path)
    except LutError as error:
        if "encodes, by" not in str(error):
            return "refused: " + str(error).partition(": ")[2].partition(" (")[0]
        reason = str(error).partition("encodes, ")[2].partition(";")[0]
        how, direction = f"applied with --direction encode, because it encodes {reason}", "encode"
        lookup = lut_lookup(path, direction)
    expected = through_ocio(path, PIXELS, inverse=backward)
    finite = np.isfinite(expected).all(axis=2)
    try:
        found = lookup.apply(PIXELS)
    except LutError:
        return "refused: makes NaN or infinity of codes" if not finite.all() else "refused"
    same = np.allclose(found[finite], expected[finite], rtol=1e-6, atol=1e-6)
    return how if same else "unlike"


def test_every_lut_is_applied_as_by_opencolorio_or_refused_by_both(peers: Path) -> None:
    ends: dict[str, list[str]] = {}
    for path in files(peers):
        refused = why_unusable(path)
        findings = lint(path)
        if refused:
            assert findings[-1].unusable, path
            assert refused in findings[-1].problem
            end = "refused by OpenColorIO, told by lint"
        else:
            assert not any(finding.unusable for finding in findings), path
            end = applied(path)
        ends.setdefault(end, []).append(path.name)
    for end, names in sorted(ends.items()):
        print(f"{len(names):4} {end}: {', '.join(sorted(names)) if end not in PLAIN else '...'}")
    if any("lut1d_infinity.ctf" in names for names in ends.values()):  # the documented collection
        page = EVIDENCE.read_text(encoding="utf-8")
        for end in ends.keys() - {*PLAIN}:
            assert [name for name in ends[end] if f"`{name}`" not in page] == [], end
    assert "unlike" not in ends
    assert "refused" not in ends


def test_lint_raises_no_false_alarm(peers: Path) -> None:
    told: Counter[str] = Counter()
    alarms = {}
    for path in files(peers):
        found = lint(path)
        own_tests = "tests/data" in path.as_posix()
        kind = "refused" if found and found[-1].unusable else "findings" if found else "clean"
        told[f"{kind}, {'OpenColorIO tests' if own_tests else 'published'}"] += 1
        if kind == "findings":
            alarms[path.name] = (own_tests, found[0].problem)
    print(dict(told))
    for name, (own_tests, problem) in sorted(alarms.items()):
        print(f"{'test' if own_tests else 'published'} {name}: {problem}")
    published = {name for name, (own_tests, _) in alarms.items() if not own_tests}
    assert published <= TRUE_FINDINGS


def of_version_2(config: Path) -> Path:
    """The config, or beside it what the message about profile version 1 says how to make of it."""
    upgraded = read(config)
    if upgraded.getMajorVersion() > 1:
        return config
    upgraded.upgradeToLatestVersion()
    made = config.with_name(f"facecrf_{config.stem}_upgraded.ocio")
    made.write_text(upgraded.serialize(), encoding="utf-8")
    return made


def merge_both_ways(config: Path, lut: Path, folder: Path) -> int:
    """Merge a config in its own folder and into another; how many ways it can go."""
    before = read(config)
    reference = None if before.hasRole("aces_interchange") else "lin_rec709"
    for output in (config.parent / "facecrf_own.ocio", folder / "other.ocio"):
        try:
            write_config([lut], output, merge=str(config), reference=reference, overwrite=True)
            ways, unlike = lost(before, read(output))
        finally:
            output.unlink(missing_ok=True)
            shutil.rmtree(output.with_name(f"{output.stem}_luts"), ignore_errors=True)
        assert unlike == [], config
    return ways


def test_every_config_goes_on_after_a_merge(peers: Path, tmp_path: Path) -> None:
    lut = write_lut(InverseCRF(GRID, np.stack([GRID**2.2] * 3)), tmp_path / "p.spi1d")
    merged: dict[str, int] = {}
    for config in sorted(peers.rglob("*.ocio")):
        name = str(config.relative_to(peers))
        try:
            read(config).validate()
        except ocio.Exception as error:
            print(f"{name}: not valid before: {str(error).strip()[:120]}")
            continue
        try:
            whole = of_version_2(config)
        except ocio.Exception as error:
            print(f"{name}: cannot be upgraded: {str(error).strip()[:120]}")
            continue
        try:
            if whole != config:
                with pytest.raises(SettingsError, match="has profile version 1"):
                    write_config([lut], tmp_path / "old.ocio", merge=str(config))
            merged[name] = merge_both_ways(whole, lut, tmp_path)
            upgraded = "" if whole == config else ", upgraded from profile version 1"
            print(f"{name}: {merged[name]} ways unchanged in two merges{upgraded}")
        finally:
            if whole != config:
                whole.unlink()
    print(f"{len(merged)} configs, {sum(merged.values())} ways")
    assert merged
