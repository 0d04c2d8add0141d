"""Pictures without a single curve are told so, and are never called reliable."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from face_photos import grace_hopper, turn
from gain_map_files import jpeg, ultra_hdr_numbers, with_gain_map, xmp
from photo_files import with_segments
from PIL import Image

from facecrf_ocio import Photo, calibrate, read_photo
from facecrf_ocio.errors import PhotoError
from facecrf_ocio.face.detect import find_faces
from facecrf_ocio.face.second_look import NOBODYS, is_nobodys
from facecrf_ocio.joint import PhotoEvidence, conclude, gather
from facecrf_ocio.joint.prior import Message
from facecrf_ocio.joint.single_curve import (
    chroma_share,
    distinct_colors,
    flat_share,
    gain_scatter,
    middle_codes,
    no_photograph,
    strange_skin,
    toned,
)
from facecrf_ocio.photo.tags.edits import edits_told, made_as_told
from facecrf_ocio.settings import FaceSettings, JointSettings
from facecrf_ocio.synthetic.jpeg import through_jpeg
from facecrf_ocio.values import Camera, Lacking, Outcome, Verdict

DEFAULTS = JointSettings()

FACE = np.array([150.0, 80.0, 200.0, 250.0])


def stored(picture: np.ndarray, quality: int = 90) -> np.ndarray:
    codes = np.rint(np.clip(picture, 0, 1) * 255).astype(np.uint8)
    _, content = cv2.imencode(".jpg", codes, [cv2.IMWRITE_JPEG_QUALITY, quality])
    return np.float32(cv2.imdecode(content, cv2.IMREAD_COLOR)) / np.float32(255)


def in_tone(exponents: tuple[float, float, float]) -> np.ndarray:
    gray = grace_hopper() @ np.float32([0.299, 0.587, 0.114])
    return np.stack([gray**exponent for exponent in exponents], axis=2)


@pytest.mark.parametrize("quality", [85, 92, 97])
@pytest.mark.parametrize("exponents", [(1.05, 1.0, 0.95), (0.95, 1.0, 1.05)])
def test_toned_black_and_white_is_refused_or_in_doubt(quality: int, exponents) -> None:
    assert toned(stored(in_tone(exponents), quality), DEFAULTS)


def test_a_tone_that_jpeg_leaves_alone_is_refused() -> None:
    unfit = toned(in_tone((1.05, 1.0, 0.95)), DEFAULTS)
    assert isinstance(unfit, Lacking)
    assert "one hue: no pigments to look at" in unfit.reason


STRONG = {
    "sepia": lambda gray: gray[..., None] * np.float32([1.07, 0.88, 0.68]),
    "selenium": lambda gray: gray[..., None] + (gray * (1 - gray))[..., None] * (0.24, -0.12, 0.2),
    "cyanotype": lambda gray: np.stack([gray**2.2, gray**1.1, gray**0.6], axis=2),
    "two inks": lambda gray: np.stack(
        [np.interp(gray, (0, 0.5, 1), ink) for ink in zip(*INKS, strict=True)], axis=2
    ),
}
INKS = (0.05, 0.06, 0.25), (0.75, 0.35, 0.3), (1.0, 0.95, 0.8)


@pytest.mark.parametrize("quality", [50, 95])
@pytest.mark.parametrize("tone", STRONG)
def test_strong_tones(tone: str, quality: int) -> None:
    gray = grace_hopper() @ np.float32([0.299, 0.587, 0.114])
    assert chroma_share(stored(STRONG[tone](gray), quality)) < DEFAULTS.sure_chroma / 1.5


def test_a_large_photo_is_told_like_a_small_one() -> None:
    picture = stored(in_tone((0.95, 1.0, 1.05)))
    large = cv2.resize(picture, None, fx=5, fy=5)
    assert large.shape[0] > 2500
    assert chroma_share(large) < DEFAULTS.sure_chroma
    assert chroma_share(cv2.resize(grace_hopper(), None, fx=5, fy=5)) > DEFAULTS.sure_chroma


@pytest.mark.parametrize("quality", [40, 95])
def test_an_ordinary_photo_is_one(quality: int) -> None:
    picture = stored(grace_hopper(), quality)
    assert no_photograph(picture, FACE, DEFAULTS) is None
    assert toned(picture, DEFAULTS) == ""
    assert chroma_share(picture) > 1.5 * DEFAULTS.sure_chroma
    codes = middle_codes(picture)
    assert len(distinct_colors(codes)) > 5 * DEFAULTS.fewest_colors
    assert flat_share(codes) < DEFAULTS.most_flat / 1.5


def test_gray_skin_in_studio_light_is_no_toned_photo(development_data: Path) -> None:
    paths = sorted((development_data / "faces" / "linear").glob("input_*.tif"))
    assert paths
    for path in paths:
        linear = np.clip(read_photo(path).encoded, 0.0, 1.0)
        encoded = stored(linear ** np.float32(1.0 / 2.2))
        assert not isinstance(toned(encoded, DEFAULTS), Lacking)


def test_a_palette() -> None:
    picture = np.round(grace_hopper() * 5) / np.float32(5)
    unfit = no_photograph(picture, FACE, DEFAULTS)
    assert unfit is not None
    assert "palette" in unfit.reason


def test_a_drawn_face() -> None:
    picture = np.array(grace_hopper())
    cv2.ellipse(picture, (250, 200), (140, 170), 0, 0, 360, (0.9, 0.7, 0.6), -1)
    unfit = no_photograph(picture, FACE, DEFAULTS)
    assert unfit is not None
    assert "drawn" in unfit.reason


@pytest.mark.parametrize("quality", [80, 90])
@pytest.mark.parametrize("darker", [8, 24, 32])
def test_a_dark_photo_is_neither_a_palette_nor_drawn(darker: int, quality: int) -> None:
    """It has few colors and little noise, but its colors are next to each other."""
    dark = stored(grace_hopper() / np.float32(darker), quality)
    assert no_photograph(dark, FACE, DEFAULTS) is None


@pytest.mark.parametrize("colors", [8, 64, 256])
@pytest.mark.parametrize("darker", [1, 4])
def test_a_palette_is_one_in_the_dark_too(colors: int, darker: int) -> None:
    codes = np.rint(255 * grace_hopper() / darker).astype(np.uint8)
    picture = Image.fromarray(codes).quantize(colors).convert("RGB")
    unfit = no_photograph(np.asarray(picture), FACE, DEFAULTS)
    assert unfit is not None
    assert "palette" in unfit.reason


def test_skin_that_is_more_blue_than_red_is_told() -> None:
    photo = np.array(grace_hopper())
    assert gather(Photo(photo)).doubt == ""
    swapped = gather(Photo(np.ascontiguousarray(photo[..., ::-1])))
    assert "more blue than red" in swapped.doubt
    confidence = conclude([replace(swapped, messages=surely(swapped))]).confidence
    assert confidence.verdict is Verdict.WEAK
    assert "negative" in strange_skin(1 - photo, FACE)
    assert strange_skin(photo * np.float32([0.7, 1.0, 1.0]), FACE) == ""
    assert strange_skin(np.zeros_like(photo), FACE) == ""


def test_skin_that_is_more_green_than_red_is_told() -> None:
    photo = np.array(grace_hopper())
    swapped = gather(Photo(np.ascontiguousarray(photo[..., [1, 0, 2]])))
    assert "more green than red" in swapped.doubt
    confidence = conclude([replace(swapped, messages=surely(swapped))]).confidence
    assert confidence is not None
    assert confidence.verdict is Verdict.WEAK


def test_calibrate_says_what_is_wrong() -> None:
    estimate = calibrate(Photo(np.clip(in_tone((0.95, 1.0, 1.05)), 0.0, 1.0)))
    assert estimate.outcome is Outcome.NOT_CALIBRATED
    assert "one hue" in estimate.reason
    assert estimate.remedy


def surely(evidence: PhotoEvidence) -> dict[str, Message]:
    """The same cues, all of one mind and very sure."""
    size = next(iter(evidence.messages.values())).mean.size
    return {cue: Message(np.zeros(size), np.full(size, 1e4)) for cue in evidence.messages}


def test_a_likely_tone_is_never_reliable() -> None:
    evidence = gather(Photo(stored(in_tone((0.95, 1.0, 1.05)))))
    assert "hardly more than one hue" in evidence.doubt
    assert PhotoEvidence.from_json(evidence.to_json()).doubt == evidence.doubt
    for one in (evidence, replace(evidence, messages=surely(evidence))):
        told = conclude([one]).confidence
        assert told.verdict is Verdict.WEAK
        assert "perhaps no single curve: it has hardly more than one hue" in told.doubts
    assert conclude([replace(one, doubt="")]).confidence.verdict is Verdict.RELIABLE
    two = conclude([one, replace(one, doubt="")], names=["a.jpg", "b.jpg"]).confidence
    assert "perhaps no single curve: a.jpg: it has hardly more than one hue" in two.doubts


@pytest.mark.parametrize(
    ("said", "software", "clauses"),
    [
        ("", "Ver.1.00", 0),
        ("", "HDR+ 1.0.570503588zd", 0),
        ("", "Adobe Photoshop CS6 (Windows)", 1),
        ("", "Instagram", 1),
        ('xmp:CreatorTool="Snapseed"', "", 1),
        ('crs:Version="15.0" crs:Clarity2012="0" crs:Dehaze="+0"', "", 0),
        ('crs:Clarity2012="+20"', "", 1),
        ("<crs:PaintBasedCorrections><rdf:Seq/></crs:PaintBasedCorrections>", "", 1),
        ('crs:Shadows2012="+45"', "Adobe Lightroom 6.0", 2),
    ],
)
def test_edits_that_the_file_tells_of(said: str, software: str, clauses: int) -> None:
    assert len(edits_told(said, software)) == clauses


SOURCE = b"http://cv.iptc.org/newscodes/digitalsourcetype/"


@pytest.mark.parametrize(
    ("content", "camera", "rendered", "beside", "told"),
    [
        (b"", Camera(), 0, "", ""),
        (SOURCE + b"trainedAlgorithmicMedia'/>", Camera(), 0, "", "(trainedAlgorithmicMedia)"),
        # A photo and what was painted into it, as C2PA lists them.
        (SOURCE + b"digitalCapture" + SOURCE + b"composite\0", Camera(), 0, "", "(composite)"),
        (SOURCE + b'negativeFilm"', Camera(), 0, "", ""),
        (SOURCE, Camera(), 0, "", ""),
        (b"", Camera(), 0, "a face\nSteps: 20, Sampler: Euler a", "recipe"),
        (b"", Camera(), 0, '{"3": {"class_type": "KSampler"}}', "recipe"),
        (b"", Camera(), 0, "Steps: take a photo, and look", ""),
        (b"", Camera("Apple", "iPhone XS"), 8, "", "(portrait mode)"),
        (b"", Camera("Apple", "iPhone 6"), 3, "", "(HDR)"),
        (b"", Camera("Apple", "iPhone 6"), 4, "", ""),  # the exposure kept beside an HDR picture
        (b"", Camera("Canon", "EOS 5D"), 1, "", ""),  # a picture style
    ],
)
def test_how_a_picture_came_to_be(
    content: bytes, camera: Camera, rendered: int, beside: str, told: str
) -> None:
    found = made_as_told(content, camera, rendered, beside)
    assert len(found) == bool(told)
    assert told in "".join(found)


def test_a_generator_signs_where_editors_do() -> None:
    assert edits_told("", "Midjourney") == ("no camera took it (Midjourney)",)
    said = 'xmp:CreatorTool="Adobe Firefly"'
    assert edits_told(said, "") == ("no camera took it (Adobe Firefly)",)


@pytest.mark.parametrize("suffix", [".png", ".jpg", ".avif", ".heic"])
def test_a_file_that_says_that_no_camera_took_it(tmp_path: Path, suffix: str) -> None:
    if suffix == ".heic":
        pytest.importorskip("pillow_heif").register_heif_opener()
    path = tmp_path / f"a{suffix}"
    packet = f"<x:xmpmeta><rdf:RDF a='{SOURCE.decode()}algorithmicMedia'/></x:xmpmeta>".encode()
    try:
        Image.new("RGB", (64, 64), (120, 90, 80)).save(path, xmp=packet)
    except (KeyError, OSError):
        pytest.skip("Pillow writes none here")
    if suffix == ".png":  # which Pillow writes without
        path.write_bytes(path.read_bytes() + packet)
    (edit,) = read_photo(path).edits
    assert edit == "no camera took it, or not all of it (algorithmicMedia)"


def test_an_edited_photo_is_never_reliable(tmp_path: Path) -> None:
    codes = np.rint(grace_hopper() * 255).astype(np.uint8)
    (tmp_path / "a.jpg").write_bytes(with_segments(jpeg(codes), xmp('xmp:CreatorTool="VSCO"')))
    photo = read_photo(tmp_path / "a.jpg")
    assert photo.edits == ("it was edited (VSCO)",)
    confidence = calibrate(photo).confidence
    assert confidence is not None
    assert confidence.verdict is not Verdict.RELIABLE
    assert any("VSCO" in doubt for doubt in confidence.doubts)
    plain = calibrate(replace(photo, edits=())).confidence
    assert plain is not None
    assert plain.doubts == ()


@pytest.mark.parametrize(
    ("is_local", "least", "most"), [(False, 0, 0.03), (True, DEFAULTS.most_scatter, 2)]
)
def test_gain_maps_tell_tone_mapping_of_places(
    tmp_path: Path, is_local: bool, least: float, most: float
) -> None:
    codes = np.rint(grace_hopper() * 255).astype(np.uint8)
    values = codes.max(axis=2)
    if is_local:
        values = cv2.GaussianBlur(values, None, 40)
    numbers = ultra_hdr_numbers(GainMapMax=2)
    (tmp_path / "a.jpg").write_bytes(with_gain_map(codes, values, numbers))
    assert least <= gain_scatter(read_photo(tmp_path / "a.jpg")) <= most


# What ../shared/cases says is right, as far as it is of a photo read and calibrated.
READ = {
    "avif.avif": (512, 512),
    "photo.heic": (512, 512),
    "jpeg_named.CR2": (512, 512),
    "jpeg_named.dng": (512, 512),
    "jpeg_named.raw": (512, 512),
    "jpeg_stray_bytes_header.jpg": (512, 512),
    "lin16_crop.dng": (400, 300),
    "thumb_first.tif": (512, 512),
    "uhdr_bright.jpg": (512, 512),
    "latin1_make.jpg": (500, 400),
    "chad_zero.jpg": (700, 560),
    "col_zero.jpg": (700, 560),
}
UNFIT = ("cyanotype.jpg", "bw_tint_warm.jpg", "palette64.png", "flat_drawing.png")


@pytest.fixture(scope="module")
def cases() -> Path:
    default = Path(__file__).resolve().parents[2] / "shared" / "cases"
    folder = Path(os.environ.get("FACECRF_CASES", default)) / "photos"
    if not folder.is_dir():
        pytest.skip(f"cases are not in {folder}; set FACECRF_CASES")
    return folder


@pytest.mark.slow
def test_the_cases_kept_beside_the_project(cases: Path) -> None:
    for name, shape in READ.items():
        try:
            photo = read_photo(cases / name)
        except PhotoError as error:
            if "install" not in str(error):  # as it says of HEIC without the extra
                raise
            continue
        assert photo.encoded.shape[:2] == shape, name
    for name in UNFIT:
        estimate = calibrate(read_photo(cases / name))
        assert estimate.outcome is Outcome.NOT_CALIBRATED, name
    dog = calibrate(read_photo(cases / "dog.png")).confidence
    assert dog is None or dog.verdict is not Verdict.RELIABLE
    for name, problem in (
        ("float16.dng", "zeros alone"),
        ("err_not_utf8.exr", "begins as OpenEXR"),
    ):
        with pytest.raises(PhotoError, match=problem):
            read_photo(cases / name)
    assert calibrate(read_photo(cases / "pix16.jxl")).outcome is Outcome.ALREADY_LINEAR
    assert calibrate(read_photo(cases / "pq_cicp.png")).outcome is Outcome.NAMED
    assert read_photo(cases / "uhdr_bright_orient6.jpg").gain_map is not None


def with_luma_inverted(codes: np.ndarray) -> np.ndarray:
    planes = cv2.cvtColor(codes, cv2.COLOR_RGB2YCrCb)
    planes[..., 0] = 255 - planes[..., 0]
    return cv2.cvtColor(planes, cv2.COLOR_YCrCb2RGB)


def with_lightness_inverted(codes: np.ndarray) -> np.ndarray:
    planes = cv2.cvtColor(codes, cv2.COLOR_RGB2LAB)
    planes[..., 0] = 255 - planes[..., 0]
    return cv2.cvtColor(planes, cv2.COLOR_LAB2RGB)


def in_order(*order: int):
    return lambda codes: codes[..., order]


INVERTED = "as with brightness inverted"
MADE_WRONG = {
    "luma inverted": (with_luma_inverted, INVERTED),
    "lightness inverted": (with_lightness_inverted, INVERTED),
    "red and blue exchanged": (in_order(2, 1, 0), "with red and blue exchanged"),
    "red and green exchanged": (in_order(1, 0, 2), "with red and green exchanged"),
    "green and blue exchanged": (in_order(0, 2, 1), "with green and blue exchanged"),
    "blue, red, green": (in_order(2, 0, 1), "with each channel in another's place"),
    "green, blue, red": (in_order(1, 2, 0), "with each channel in another's place"),
}


@pytest.mark.parametrize("quality", [None, 80])
@pytest.mark.parametrize("name", MADE_WRONG)
def test_a_faces_own_parts_tell_how_its_picture_was_made_wrong(
    name: str, quality: int | None
) -> None:
    make, told = MADE_WRONG[name]
    wrong = np.ascontiguousarray(make(np.rint(grace_hopper() * 255).astype(np.uint8)))
    wrong = wrong if quality is None else through_jpeg(wrong, quality, "4:2:0")
    evidence = gather(Photo.of_codes(wrong))
    assert told in evidence.doubt
    confidence = conclude([replace(evidence, messages=surely(evidence))]).confidence
    assert confidence is not None
    assert confidence.verdict is Verdict.WEAK


def in_gray_light(photo: np.ndarray) -> np.ndarray:
    """Light in which her skin is gray, and half of the color that is left."""
    skin = np.median(photo[180:280, 220:320].reshape(-1, 3), axis=0)
    even = photo * (skin.mean() / skin)
    return np.clip(0.5 * even + 0.5 * even.mean(axis=2, keepdims=True), 0.0, 1.0)


@pytest.mark.parametrize(
    "order", [(0, 1, 2), (2, 1, 0), (1, 0, 2), (0, 2, 1), (1, 2, 0), (2, 0, 1)]
)
def test_channels_tell_their_order_in_gray_light_too(order: tuple) -> None:
    photo = np.float32(in_gray_light(grace_hopper())[..., order])
    said = gather(Photo(np.ascontiguousarray(photo))).doubt
    assert ("channels seem swapped" in said) == (order != (0, 1, 2))


def with_a_mask(photo: np.ndarray, color: tuple) -> np.ndarray:
    """A cloth from her nose down."""
    (face,) = find_faces(photo, FaceSettings()).faces
    points = face.landmarks_xyz[:, :2]
    covered = np.zeros(photo.shape[:2], np.uint8)
    below = points[points[:, 1] > points[4, 1]]  # MediaPipe's tip of the nose
    cv2.fillConvexPoly(covered, cv2.convexHull(np.rint(below).astype(np.int32)), 1)
    folds = np.exp(0.15 * np.sin(np.arange(len(photo)) / 6.0))[:, None, None]
    cloth = np.float32(color) / 255 * folds + np.random.default_rng(0).normal(0, 0.01, photo.shape)
    return np.clip(np.where(covered[..., None] > 0, cloth, photo), 0, 1).astype(np.float32)


@pytest.mark.parametrize("color", [(150, 195, 225), (60, 110, 50), (40, 60, 130)])
def test_a_covered_mouth_tells_no_order_of_channels(color: tuple) -> None:
    masked = with_a_mask(grace_hopper(), color)
    assert "channels seem swapped" not in gather(Photo(masked)).doubt


@pytest.mark.parametrize("gains", [(1, 1, 1), (1.2, 1, 0.7), (0.8, 1, 1.25), (1.1, 0.85, 1.1)])
@pytest.mark.parametrize("exposure", [0.3, 1.0, 1.6])
def test_a_face_in_any_light_is_as_it_should_be(gains: tuple, exposure: float) -> None:
    lit = np.clip(grace_hopper() * np.float32(gains) * np.float32(exposure), 0, 1)
    assert gather(Photo(lit)).doubt == ""


class TestASecondLook:
    """A face that one detector is not sure of, and the other does not see, is nobody's."""

    @pytest.mark.parametrize("degrees", [0, 45, 90, 180, 300])
    @pytest.mark.parametrize("scale", [0.5, 1.0, 2.0])
    def test_somebodys_face_however_turned(self, degrees: int, scale: float) -> None:
        turned, _ = turn(cv2.resize(grace_hopper(), None, fx=scale, fy=scale), degrees)
        (face,) = find_faces(turned, FaceSettings()).faces
        assert not is_nobodys(turned, replace(face, score=0.8))

    @pytest.mark.parametrize("dtype", [np.uint8, np.float32])
    def test_nobodys(self, dtype: type) -> None:
        (face,) = find_faces(grace_hopper(), FaceSettings()).faces
        plain = cv2.GaussianBlur(grace_hopper(), (0, 0), 40)
        plain = np.rint(255 * plain).astype(np.uint8) if dtype is np.uint8 else plain
        assert is_nobodys(plain, replace(face, score=0.8))
        assert not is_nobodys(plain, replace(face, score=0.95))  # the first detector is sure

    @pytest.mark.parametrize("scale", [1.0, 3.7, 7.0])
    def test_at_the_edge_of_the_picture(self, scale: float) -> None:
        photo = cv2.resize(grace_hopper(), None, fx=scale, fy=scale)
        (face,) = find_faces(photo, FaceSettings()).faces
        x, y, width, height = face.box_xy.astype(int)
        cut = photo[y : y + height, x : x + width]
        here = face.landmarks_xyz - np.array([x, y, 0.0])
        assert not is_nobodys(cut, replace(face, score=0.8, landmarks_xyz=here))

    def test_is_told_and_never_reliable(self, monkeypatch: pytest.MonkeyPatch) -> None:
        photo = Photo(grace_hopper())
        monkeypatch.setattr("facecrf_ocio.joint.evidence.is_nobodys", lambda *_: True)
        evidence = gather(photo)
        assert NOBODYS in evidence.doubt
        told = conclude([evidence]).confidence
        assert told.verdict is not Verdict.RELIABLE
        assert any(NOBODYS in doubt for doubt in told.doubts)
