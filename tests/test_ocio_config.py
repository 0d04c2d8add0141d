"""Configs of many photos: pixels through them equal the LUTs, whatever the photos are called."""

from __future__ import annotations

import copy
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import PyOpenColorIO as ocio  # noqa: N813
import pytest
from command_line import CommandLine
from PIL import Image
from privileges import without_privileges

from facecrf_ocio.color.primaries import known_primaries
from facecrf_ocio.color.working_space import working_space_matrix
from facecrf_ocio.errors import LutError, OutputError, SettingsError
from facecrf_ocio.ocio_config import VARIABLE_SPACE, PhotoLut, name_luts, write_config
from facecrf_ocio.record.outputs import write_outputs
from facecrf_ocio.settings import Settings
from facecrf_ocio.values import Estimate, InverseCRF, Outcome, Photo

ODD = ["plain", "two words", 'it\'s "quoted"', "$HOME", "%d 100%", "déjà vu 写真", "-o", "a(1)[2]+"]
CODES = np.repeat(np.linspace(0.0, 1.0, 257, dtype=np.float32)[:, None], 3, axis=1)


def write_spi1d(path, gamma):
    path.parent.mkdir(exist_ok=True, parents=True)
    rows = "".join(f"{v:.9g}\n" for v in np.linspace(0, 1, 4096) ** gamma)
    path.write_text(f"Version 1\nFrom 0 1\nLength 4096\nComponents 1\n{{\n{rows}}}\n")
    return path


def through(config, source, target, context=None):
    context = context or config.getCurrentContext()
    pixels = CODES.copy()
    processor = config.getProcessor(context, source, target)
    processor.getOptimizedCPUProcessor(ocio.OptimizationFlags.OPTIMIZATION_LOSSLESS).applyRGB(
        pixels
    )
    return pixels


def expected(gamma):
    return np.interp(CODES, np.linspace(0, 1, 4096), np.linspace(0, 1, 4096) ** gamma)


@pytest.mark.parametrize("suffix", [".ocio", ".ocioz"])
def test_each_photo_goes_through_its_own_curve_by_its_name(tmp_path, suffix):
    gammas = {stem: 1.5 + 0.1 * number for number, stem in enumerate(ODD)}
    for stem, gamma in gammas.items():
        write_spi1d(tmp_path / "in" / f"{stem}.spi1d", gamma)
    output = tmp_path / f"config{suffix}"
    write_config([tmp_path / "in"], output)
    shutil.rmtree(tmp_path / "in")
    config = ocio.Config.CreateFromFile(str(output))
    config.validate()
    for stem, gamma in gammas.items():
        space, _ = config.getColorSpaceFromFilepath(f"/photos/{stem}.jpg")
        assert config.getColorSpace(space).getEncoding() == "sdr-video"
        assert np.abs(through(config, space, "scene_linear") - expected(gamma)).max() < 1e-6
    assert config.getColorSpaceFromFilepath("/photos/other plain.jpg")[0] == "default"


def test_two_photos_of_one_name_are_told_apart_by_their_folders(tmp_path):
    luts = [write_spi1d(tmp_path / folder / "p.spi1d", g) for folder, g in (("a", 1.8), ("b", 2.4))]
    write_config(luts, tmp_path / "config.ocio")
    config = ocio.Config.CreateFromFile(str(tmp_path / "config.ocio"))
    for folder, gamma in (("a", 1.8), ("b", 2.4)):
        space, _ = config.getColorSpaceFromFilepath(f"/x/{folder}/p.png")
        assert np.abs(through(config, space, "scene_linear") - expected(gamma)).max() < 1e-6


def test_a_photo_is_told_by_as_many_folders_as_it_takes(tmp_path):
    gammas = {"p": 1.6, "a/p": 1.8, "x/a/p": 2.0, "y/a/p": 2.2, "y/b/p": 2.4, "y/b/q": 2.6}
    for place, gamma in gammas.items():
        write_spi1d(tmp_path / "luts" / f"{place}.spi1d", gamma)
    write_config([tmp_path / "luts"], tmp_path / "config.ocio")
    config = ocio.Config.CreateFromFile(str(tmp_path / "config.ocio"))
    for place, gamma in gammas.items():
        for path in (f"/photos/{place}.jpg", f"C:\\photos\\{place}.jpg".replace("/", "\\")):
            space, _ = config.getColorSpaceFromFilepath(path)
            assert np.abs(through(config, space, "scene_linear") - expected(gamma)).max() < 1e-6


def calibrated(folder, photos, formats=("spi1d",)):
    """Files as a calibration leaves them: {file name: (gamma, name of primaries)}."""
    for name, (gamma, primaries) in photos.items():
        nodes = np.linspace(0, 1, 4096)
        found = InverseCRF(nodes, np.stack([nodes**gamma] * 3))
        photo = Photo(
            np.zeros((2, 3, 3), np.float32),
            path=Path(name),
            primaries=known_primaries(primaries, "ICC profile") if primaries else None,
        )
        estimate = Estimate(Outcome.CALIBRATED, "face", "found", found=found)
        write_outputs(photo, estimate, Settings(), folder, formats)


MIXED = {"a.jpg": (2.0, None), "b.jpg": (2.2, "Display P3"), "c.jpg": (2.4, "Adobe RGB")}


def in_space(gamma, primaries, space):
    given = known_primaries(primaries, "ICC profile") if primaries else None
    return expected(gamma) @ working_space_matrix(given, space).T


def test_each_photos_primaries_are_those_of_its_record(tmp_path):
    calibrated(tmp_path / "luts", MIXED)
    write_config([tmp_path / "luts"], tmp_path / "config.ocio")
    config = ocio.Config.CreateFromFile(str(tmp_path / "config.ocio"))
    for name, (gamma, primaries) in MIXED.items():
        space, _ = config.getColorSpaceFromFilepath(f"/photos/{name}")
        wanted = in_space(gamma, primaries, "lin_rec709")
        assert np.abs(through(config, space, "lin_rec709") - wanted).max() < 1e-6
    given = known_primaries("Rec.2020", "assumed")
    write_config([tmp_path / "luts"], tmp_path / "given.ocio", primaries=given)
    config = ocio.Config.CreateFromFile(str(tmp_path / "given.ocio"))
    wanted = in_space(2.2, "Rec.2020", "lin_rec709")
    assert np.abs(through(config, "facecrf_b.jpg", "lin_rec709") - wanted).max() < 1e-6


@pytest.mark.parametrize("suffix", [".ocio", ".ocioz"])
def test_a_context_variable_chooses_the_primaries_too(tmp_path, suffix):
    calibrated(tmp_path / "luts", MIXED)
    output = tmp_path / f"config{suffix}"
    write_config([tmp_path / "luts"], output, form="variable", space="acescg")
    shutil.rmtree(tmp_path / "luts")
    config = ocio.Config.CreateFromFile(str(output))
    context = copy.deepcopy(config.getCurrentContext())
    for name, (gamma, primaries) in MIXED.items():
        context["FACECRF_PHOTO"] = name
        found = through(config, VARIABLE_SPACE, "ACEScg", context)
        assert np.abs(found - in_space(gamma, primaries, "acescg")).max() < 1e-6
    unset = through(config, VARIABLE_SPACE, "lin_rec709")
    assert np.abs(unset - magenta(config)).max() < 1e-6


@pytest.mark.parametrize(
    ("space", "name"),
    [
        *(("acescg", "ACEScg"), ("lin_p3d65", "lin_p3d65"), ("aces2065-1", "ACES2065-1")),
        ("lin_rec709", "lin_rec709"),
    ],
)
def test_scene_linear_is_the_working_space_asked_for(tmp_path, space, name):
    calibrated(tmp_path / "luts", MIXED)
    write_config([tmp_path / "luts"], tmp_path / "config.ocio", space=space)
    config = ocio.Config.CreateFromFile(str(tmp_path / "config.ocio"))
    config.validate()
    assert config.getRoleColorSpace("scene_linear") == name
    wanted = in_space(2.2, "Display P3", space)
    assert np.abs(through(config, "facecrf_b.jpg", "scene_linear") - wanted).max() < 1e-6
    builtin = "ocio://cg-config-v1.0.0_aces-v1.3_ocio-v2.1"
    with pytest.raises(SettingsError, match='leave out space="acescg"'):
        write_config([tmp_path / "luts"], tmp_path / "m.ocio", merge=builtin, space="acescg")


def test_luts_that_encode_or_lead_to_a_working_space_are_known_as_such(tmp_path):
    photos = {"b.jpg": (2.2, "Display P3")}
    formats = ("acescg.clf", "encode.iridas.cube", "encode.cube")
    calibrated(tmp_path / "one", photos, formats)
    calibrated(tmp_path / "all", photos, (*formats, "iridas.cube", "clf"))
    for folder, suffix in (("one", "clf"), ("all", "cube")):
        for record in (True, False):
            if not record:  # the names alone must tell, the primaries are not known then
                (tmp_path / folder / "b.jpg.crf.json").unlink()
            output = tmp_path / f"{folder}{record}.ocio"
            _, *files = write_config([tmp_path / folder], output)
            assert [file.name for file in files] == [f"facecrf_b.jpg.{suffix}"]
            config = ocio.Config.CreateFromFile(str(output))
            space, _ = config.getColorSpaceFromFilepath("/photos/b.jpg")
            kept = "Display P3" if record or folder == "one" else None
            wanted = in_space(2.2, kept, "lin_rec709")
            assert np.abs(through(config, space, "scene_linear") - wanted).max() < 2e-6
    with pytest.raises(
        LutError, match=r"b\.jpg\.encode\.cube: it encodes; name the LUT that linearizes"
    ):
        write_config([tmp_path / "all" / "b.jpg.encode.cube"], tmp_path / "c.ocio")


def test_a_photos_own_name_is_not_taken_for_a_direction(tmp_path):
    calibrated(tmp_path / "luts", {"b.encode.jpg": (2.2, None), "b.acescg.jpg": (2.4, None)})
    write_config([tmp_path / "luts"], tmp_path / "config.ocio")
    config = ocio.Config.CreateFromFile(str(tmp_path / "config.ocio"))
    for name, gamma in (("b.encode.jpg", 2.2), ("b.acescg.jpg", 2.4)):
        space, _ = config.getColorSpaceFromFilepath(f"/photos/{name}")
        assert np.abs(through(config, space, "scene_linear") - expected(gamma)).max() < 1e-6


@pytest.mark.parametrize("record", [True, False])
def test_luts_of_an_archive_are_told_by_the_photos_full_names(tmp_path, record):
    photos = {"a.jpg": (2.0, None), "a.png": (2.4, None)}
    calibrated(tmp_path / "luts" / "sub", photos)
    if not record:
        for path in (tmp_path / "luts" / "sub").glob("*.crf.json"):
            path.unlink()
    write_config([tmp_path / "luts"], tmp_path / "config.ocio")
    config = ocio.Config.CreateFromFile(str(tmp_path / "config.ocio"))
    for name, (gamma, _) in photos.items():
        space, _ = config.getColorSpaceFromFilepath(f"/photos/sub/{name}")
        assert np.abs(through(config, space, "scene_linear") - expected(gamma)).max() < 1e-6
    assert config.getColorSpaceFromFilepath("/photos/sub/b.jpg")[0] == "default"


CONFIGS = {
    "spaces": {},
    "variable": {"form": "variable"},
    "acescg": {"space": "acescg"},
    "cg": {"merge": "ocio://cg-config-v1.0.0_aces-v1.3_ocio-v2.1"},
    "studio": {"merge": "ocio://studio-config-v1.0.0_aces-v1.3_ocio-v2.1", "form": "variable"},
}


@pytest.mark.parametrize("suffix", [".ocio", ".ocioz"])
@pytest.mark.parametrize("name", CONFIGS)
def test_ociocheck_has_nothing_to_say(tmp_path, name, suffix):
    calibrated(tmp_path / "luts", MIXED)
    for stem in ODD:
        write_spi1d(tmp_path / "luts" / f"{stem}.spi1d", 2.2)
    output = tmp_path / f"config{suffix}"
    write_config([tmp_path / "luts"], output, **CONFIGS[name])
    told = run_tool("ociocheck", "--iconfig", output)
    assert "Validation: passed" in told
    assert "WARNING" not in told
    assert "ERROR" not in told
    # Blender 5.0 reads none newer.
    config = ocio.Config.CreateFromFile(str(output))
    assert (config.getMajorVersion(), config.getMinorVersion()) <= (2, 4)


def run_tool(name, *arguments):
    """What a program that stands beside this Python tells."""
    tool = Path(sys.executable).parent / name
    if not tool.exists():
        pytest.skip(f"no {name} beside this Python")
    command = [str(tool), *map(str, arguments)]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stdout + ended.stderr
    return ended.stdout + ended.stderr


def config_space(folder, name):
    config = ocio.Config.CreateFromFile(str(folder / "config.ocio"))
    return config.getColorSpaceFromFilepath(f"/x/{name}")[0]


@pytest.mark.parametrize(
    ("space", "interop"), [("lin_rec709", "lin_rec709_scene"), ("acescg", "lin_ap1_scene")]
)
def test_oiiotool_finds_the_photos_space_if_asked_before_it_reads(tmp_path, space, interop):
    oiio = pytest.importorskip("OpenImageIO")
    calibrated(tmp_path / "luts", {"b.png": (3.0, "Display P3")})
    write_config([tmp_path / "luts"], tmp_path / "config.ocio", space=space)
    codes = np.random.default_rng(0).integers(0, 256, (8, 16, 3), np.uint8)
    Image.fromarray(codes).save(tmp_path / "b.png")
    start = ("--colorconfig", tmp_path / "config.ocio")
    end = ("-d", "float", "-o", tmp_path / "b.exr")
    run_tool("oiiotool", *start, "--autocc", tmp_path / "b.png", *end)
    image = oiio.ImageBuf(str(tmp_path / "b.exr"))
    primaries = known_primaries("Display P3", "ICC profile")
    curve = np.interp(codes / 255, np.linspace(0, 1, 4096), np.linspace(0, 1, 4096) ** 3.0)
    wanted = curve @ working_space_matrix(primaries, space).T
    assert np.abs(image.get_pixels(oiio.FLOAT) - wanted).max() < 1e-5
    assert image.spec().getattribute("colorInteropID") == interop
    assert config_space(tmp_path, "b.exr") == "default"  # or --autocc would encode the output
    # Behind the input's name it comes too late; the README says so.
    run_tool("oiiotool", *start, tmp_path / "b.png", "--autocc", *end)
    image = oiio.ImageBuf(str(tmp_path / "b.exr"))
    assert np.abs(image.get_pixels(oiio.FLOAT) - wanted).max() > 0.05


def test_names_differ_even_without_regard_to_case(tmp_path):
    entries = name_luts(
        [PhotoLut(tmp_path / f"{stem}.spi1d", stem) for stem in ("A b", "a_b", "a$b")]
    )
    assert len({entry.name.lower() for entry in entries}) == 3


def magenta(config):
    """Light of sRGB, of whose greens a 64th is left."""
    return through(config, "srgb", "lin_rec709") * [1, 1 / 64, 1]


@pytest.mark.parametrize("suffix", [".ocio", ".ocioz"])
def test_a_context_variable_chooses_the_photo_and_has_a_default(tmp_path, suffix):
    lut = write_spi1d(tmp_path / "in" / "p.spi1d", 2.2)
    output = tmp_path / f"config{suffix}"
    write_config([lut], output, form="variable")
    config = ocio.Config.CreateFromFile(str(output))
    context = copy.deepcopy(config.getCurrentContext())
    context["FACECRF_PHOTO"] = "p"
    photo = through(config, VARIABLE_SPACE, "scene_linear", context)
    assert np.abs(photo - expected(2.2)).max() < 1e-6
    # Not named, it is told by its looks: a plain curve would pass for the photo's.
    assert config.getEnvironmentVarDefault("FACECRF_PHOTO") == "no_photo_named"
    unset = through(config, VARIABLE_SPACE, "scene_linear")
    assert np.abs(unset - magenta(config)).max() < 1e-6


@pytest.mark.parametrize("suffix", [".ocio", ".ocioz"])
def test_a_built_in_aces_config_keeps_its_roles_and_rules(tmp_path, suffix):
    name = "ocio://cg-config-v1.0.0_aces-v1.3_ocio-v2.1"
    lut = write_spi1d(tmp_path / "in" / "p.spi1d", 2.2)
    write_config([lut], tmp_path / f"config{suffix}", merge=name)
    merged = ocio.Config.CreateFromFile(str(tmp_path / f"config{suffix}"))
    before = ocio.Config.CreateFromFile(name)
    assert list(merged.getRoles()) == list(before.getRoles())
    rules, former = merged.getFileRules(), before.getFileRules()
    kept = [rules.getName(i) for i in range(1, rules.getNumEntries())]
    assert kept == [former.getName(i) for i in range(former.getNumEntries())]
    wanted = expected(2.2) @ working_space_matrix(None, "acescg").T
    assert np.abs(through(merged, "facecrf_p", "ACEScg") - wanted).max() < 1e-6


def test_a_studio_config_finds_its_own_luts_from_its_new_folder(tmp_path):
    studio = tmp_path / "studio"
    write_spi1d(studio / "luts" / "log.spi1d", 3.0)
    (studio / "config.ocio").write_text(
        "ocio_profile_version: 2\nsearch_path: luts\nroles:\n  default: raw\n"
        "  scene_linear: lin\nfile_rules:\n"
        "  - !<Rule> {name: jpegs, pattern: '*', extension: jpg, colorspace: log}\n"
        "  - !<Rule> {name: Default, colorspace: default}\n"
        "displays:\n  d:\n    - !<View> {name: v, colorspace: raw}\ncolorspaces:\n"
        "  - !<ColorSpace> {name: raw, isdata: true}\n  - !<ColorSpace> {name: lin}\n"
        "  - !<ColorSpace> {name: log, to_scene_reference: !<FileTransform> {src: log.spi1d}}\n"
    )
    lut = write_spi1d(tmp_path / "in" / "p.spi1d", 2.2)
    with pytest.raises(SettingsError, match=r"pass reference=\.\.\."):
        write_config([lut], tmp_path / "new.ocio", merge=str(studio / "config.ocio"))
    write_config(
        [lut],
        tmp_path / "new.ocio",
        merge=str(studio / "config.ocio"),
        reference="lin_rec709",
    )
    config = ocio.Config.CreateFromFile(str(tmp_path / "new.ocio"))
    assert np.abs(through(config, "log", "lin") - expected(3.0)).max() < 1e-6
    assert config.getColorSpaceFromFilepath("x/p.jpg")[0] == "facecrf_p"
    assert config.getColorSpaceFromFilepath("x/q.jpg")[0] == "log"


def test_the_command_tells_what_it_wrote_or_why_not_in_one_line(tmp_path, capfd):
    run = CommandLine(capfd)
    luts = tmp_path / "luts"
    write_spi1d(luts / "p.spi1d", 2.2)
    (luts / "q.encode.spi1d").write_bytes((luts / "p.spi1d").read_bytes())
    for name, said in (
        ("a.ocio", "config with 1 file beside it"),
        ('ü $ "q".ocioz', "config with its LUTs inside"),
    ):
        ended = run("ocio-config", luts, "-o", tmp_path / name, "--to", "acescg")
        assert (ended.code, ended.out) == (0, f"{tmp_path / name}: {said}\n")
        ocio.Config.CreateFromFile(str(tmp_path / name)).validate()
    (tmp_path / "empty").mkdir()
    new = tmp_path / "new.ocio"
    builtin = "ocio://cg-config-v1.0.0_aces-v1.3_ocio-v2.1"
    for code, problem, arguments in (
        (1, "exists already", (luts, "-o", tmp_path / "a.ocio")),
        (
            1,
            "no such file or directory; choose another folder",
            (luts, "-o", tmp_path / "missing" / "a.ocio"),
        ),
        (1, "give it .ocio or .ocioz", (luts, "-o", tmp_path / "a.txt")),
        (2, "'none.ocio' file does not exist", (luts, "-o", new, "--merge", "none.ocio")),
        (2, "unpack it", (luts, "-o", new, "--merge", tmp_path / 'ü $ "q".ocioz')),
        (2, "not a config", (luts, "-o", new, "--merge", luts / "p.spi1d")),
        (2, "not a config", (luts, "-o", new, "--merge", "ocio://nothing")),
        (2, "leave out --to acescg", (luts, "-o", new, "--merge", builtin, "--to", "acescg")),
        (3, "it encodes", (luts / "q.encode.spi1d", "-o", new)),
        (3, "no LUT", (tmp_path / "empty", "-o", new)),
    ):
        ended = run("ocio-config", *arguments)
        assert (ended.code, ended.out) == (code, "")
        assert problem in ended.err
        assert ended.err.count("\n") == 1
    assert not new.exists()


def test_oiiotool_converts_through_the_config(tmp_path):
    oiio = pytest.importorskip("OpenImageIO")
    beside = Path(sys.executable).parent / "oiiotool"
    tool = str(beside) if beside.is_file() else shutil.which("oiiotool")
    if tool is None:
        pytest.skip("no oiiotool")
    lut = write_spi1d(tmp_path / "in" / "p.spi1d", 2.2)
    write_config([lut], tmp_path / "config.ocio")
    image = oiio.ImageBuf(np.ascontiguousarray(CODES[None]))
    image.write(str(tmp_path / "codes.exr"))
    subprocess.run(
        [
            tool,
            "--colorconfig",
            tmp_path / "config.ocio",
            tmp_path / "codes.exr",
            "--colorconvert",
            "facecrf_p",
            "lin_rec709",
            "-d",
            "float",
            "-o",
            tmp_path / "out.exr",
        ],
        check=True,
    )
    result = oiio.ImageBuf(str(tmp_path / "out.exr")).get_pixels(oiio.FLOAT)[0]
    assert np.abs(result - expected(2.2)).max() < 1e-6


def test_nothing_is_replaced_and_nothing_is_left_half_written(tmp_path):
    lut = write_spi1d(tmp_path / "in" / "p.spi1d", 2.2)
    output = tmp_path / "config.ocio"
    write_config([lut], output)
    before = output.read_bytes()
    with pytest.raises(OutputError, match="pass overwrite=True"):
        write_config([lut], output)
    write_config([lut], output, overwrite=True)
    assert output.read_bytes() == before
    with pytest.raises(OutputError, match="cannot be written"):
        write_config([lut], tmp_path / "missing" / "config.ocio")
    with pytest.raises(LutError, match="does not exist"):
        write_config([tmp_path / "none.spi1d"], tmp_path / "other.ocio")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["config.ocio", "config_luts", "in"]


def test_a_folder_one_may_not_write_to_or_read_is_told():
    with tempfile.TemporaryDirectory() as name:  # pytest's own folder is closed to others
        top = Path(name)
        top.chmod(0o755)
        lut = write_spi1d(top / "in" / "p.spi1d", 2.2)
        (top / "closed").mkdir(mode=0o555)
        for suffix in (".ocio", ".ocioz"):
            with without_privileges(), pytest.raises(OutputError, match="permission denied"):
                write_config([lut], top / "closed" / f"config{suffix}")
        assert not list((top / "closed").iterdir())
        (top / "in").chmod(0o000)
        with without_privileges(), pytest.raises(LutError, match="cannot be read: permission"):
            write_config([lut], top / "config.ocio")
        (top / "in").chmod(0o755)


LIMITED = """
import resource, sys
from pathlib import Path
from facecrf_ocio.errors import OutputError
from facecrf_ocio.ocio_config import write_config
resource.setrlimit(resource.RLIMIT_FSIZE, (10000, 10000))
try:
    write_config([Path(sys.argv[1])], Path(sys.argv[2]))
except OutputError as error:
    print(error)
"""


@pytest.mark.parametrize("suffix", [".ocio", ".ocioz"])
def test_a_write_that_the_system_cuts_short_leaves_nothing(tmp_path, suffix):
    pytest.importorskip("resource")
    lut = write_spi1d(tmp_path / "in" / "p.spi1d", 2.2)
    (tmp_path / "out").mkdir()
    output = tmp_path / "out" / f"config{suffix}"
    command = [sys.executable, "-c", LIMITED, str(lut), str(output)]
    ended = subprocess.run(command, check=True, capture_output=True, text=True)
    assert ended.stdout.count("\n") == 1
    assert f"config{suffix}: no room to prepare it (File too large)" in ended.stdout
    assert not list((tmp_path / "out").iterdir())
