"""The picture of a calibration, looked at by its pixels and its parts."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from PIL import Image

from facecrf_ocio.calibrate import calibrate
from facecrf_ocio.errors import NotCalibratedError, OutputError
from facecrf_ocio.face.skin_mask import SkinMask
from facecrf_ocio.face.view import FaceView
from facecrf_ocio.plots import calibration_plot
from facecrf_ocio.plots.calibration_plot import dimmed_face, pair_positions, plot_draft, write_plot
from facecrf_ocio.published.face_estimator import AnalyzedFace
from facecrf_ocio.published.gradients import PigmentGradients
from facecrf_ocio.settings import Settings
from facecrf_ocio.synthetic import gamma_curve
from facecrf_ocio.values import Estimate, Face, Photo

SETTINGS = Settings()
NOISE = np.random.default_rng(5).random((6, 5, 3), np.float32)


def estimate_of(photo: Photo, estimator: str = "mean") -> Estimate:
    return calibrate(photo, estimator=estimator, settings=SETTINGS)


def analyzed_face() -> AnalyzedFace:
    """A face of 6 x 5 pixels, whose skin is columns 1 to 3 of rows 1 to 4."""
    skin = np.zeros((6, 5), dtype=bool)
    skin[1:5, 1:4] = True
    diffuse = skin.copy()
    diffuse[4] = False
    histogram = np.zeros(180)
    histogram[[179, 0, 1]] = 0.25, 0.5, 0.25
    pairs = np.array([[0, 1], [1, 4], [3, 6]])  # right, down, down; skin pixels count row by row
    gradients = PigmentGradients(pairs, np.array([True, False, False]))
    view = FaceView(Face(np.zeros(4), np.zeros((478, 3)), 1.0), NOISE, None, NOISE)  # type: ignore[arg-type]
    mask = SkinMask(skin, diffuse, 1.0, histogram)
    return AnalyzedFace(view, mask, None, None, gradients)  # type: ignore[arg-type]


class TestParts:
    def test_skin_is_bright_and_the_rest_dimmed(self) -> None:
        face = analyzed_face()
        picture, diffuse = dimmed_face(face), face.mask.diffuse
        assert np.array_equal(picture[diffuse], NOISE[diffuse])
        assert np.allclose(picture[~diffuse], calibration_plot.DIMMED * NOISE[~diffuse])

    def test_pairs_lie_between_their_pixels(self) -> None:
        melanin, hemoglobin = pair_positions(analyzed_face())
        assert melanin.tolist() == [[1.5, 1.0]]
        assert hemoglobin.tolist() == [[2.0, 1.5], [1.0, 2.5]]


class TestFigures:
    """What is drawn, read back from the figure that is saved."""

    def drawn(
        self, monkeypatch: pytest.MonkeyPatch, photo: Photo, estimate: Estimate
    ) -> dict[str, Axes]:
        figures: list[Figure] = []
        save = Figure.savefig

        def keep(figure: Figure, *args: object, **options: object) -> None:
            figures.append(figure)
            save(figure, *args, **options)

        monkeypatch.setattr(Figure, "savefig", keep)
        plot_draft(Path("a.png"), photo, estimate, SETTINGS)
        (figure,) = figures
        self.expect_all_text_inside(figure)
        return {axes.get_title() or axes.get_ylabel(): axes for axes in figure.axes}

    @staticmethod
    def expect_all_text_inside(figure: Figure) -> None:
        figure.canvas.draw()
        width, height = figure.canvas.get_width_height()
        titles = [figure._suptitle, *(axes.title for axes in figure.axes)]
        labels = [axis.label for axes in figure.axes for axis in (axes.xaxis, axes.yaxis)]
        for text in (*titles, *labels):
            if text.get_text() and text.get_visible():
                box = text.get_window_extent()
                assert box.x0 >= 0
                assert box.y0 >= 0
                assert box.x1 <= width
                assert box.y1 <= height

    def test_equal_curves_are_drawn_once_beside_srgb(self, monkeypatch: pytest.MonkeyPatch) -> None:
        photo = Photo(NOISE, path=Path("a" * 200 + ".jpg"))
        axes = self.drawn(monkeypatch, photo, estimate_of(photo))["inverse camera response"]
        srgb, curve = axes.get_lines()[:2]
        assert (srgb.get_label(), srgb.get_linestyle()) == ("sRGB", ":")
        assert np.interp(0.5, srgb.get_xdata(), srgb.get_ydata()) == pytest.approx(0.214, abs=1e-3)
        assert curve.get_label() == "R = G = B, 90 % band"
        assert len(axes.collections) == 1

    def test_linear_photos_have_no_band(self, monkeypatch: pytest.MonkeyPatch) -> None:
        photo = Photo(NOISE, scene_linear=True)
        axes = self.drawn(monkeypatch, photo, estimate_of(photo))["inverse camera response"]
        _, curve = axes.get_lines()[:2]
        assert np.array_equal(curve.get_xdata(), curve.get_ydata())
        assert (curve.get_label(), len(axes.collections)) == ("R = G = B", 0)

    def test_with_a_face(self, monkeypatch: pytest.MonkeyPatch) -> None:
        photo = Photo(NOISE)
        face = analyzed_face()
        found = estimate_of(photo)
        estimate = Estimate(
            found.outcome,
            "face",
            "1 face, 1 melanin and 2 hemoglobin pairs",
            found=gamma_curve([1.8, 2.0, 2.2]),
            confidence=found.confidence,
            faces=(face.view.face,),
        )
        monkeypatch.setattr(calibration_plot, "cut_face", lambda *_: face.view)
        monkeypatch.setattr(calibration_plot, "analyze_face", lambda *_: face)
        panels = self.drawn(monkeypatch, photo, estimate)
        lines = panels["inverse camera response"].get_lines()
        labels = [line.get_label() for line in lines if line.get_label() != "_unseen"]
        assert labels == ["sRGB", "R, 90 % band", "G, 90 % band", "B, 90 % band"]
        pairs = panels["diffuse skin, single-pigment pairs"]
        assert [marks.get_label() for marks in pairs.collections] == [
            "melanin only (1)",
            "hemoglobin only (2)",
        ]
        heights = [bar.get_height() for bar in panels["% of skin"].patches]
        assert sorted(heights)[-3:] == [25.0, 25.0, 50.0]  # across 0 degrees, where hue wraps


class TestFile:
    photo = Photo(NOISE, path=Path("写真 $x$\n.jpg"))

    def test_is_a_png_whatever_the_name_of_the_photo(self, tmp_path: Path) -> None:
        written = write_plot(tmp_path / "a.png", self.photo, estimate_of(self.photo), SETTINGS)
        with Image.open(written) as picture:
            assert picture.format == "PNG"
            assert min(picture.size) > 600
            assert len(np.unique(np.asarray(picture))) > 50

    def test_a_draft_is_not_written_yet(self, tmp_path: Path) -> None:
        draft = plot_draft(tmp_path / "a.png", self.photo, estimate_of(self.photo), SETTINGS)
        assert draft.target == tmp_path / "a.png"
        assert list(tmp_path.iterdir()) == []
        Image.open(BytesIO(draft.content)).verify()

    def test_existing_files_are_kept(self, tmp_path: Path) -> None:
        (tmp_path / "a.png").write_text("mine")
        with pytest.raises(OutputError, match="exists already"):
            write_plot(tmp_path / "a.png", self.photo, estimate_of(self.photo), SETTINGS)
        assert (tmp_path / "a.png").read_text() == "mine"

    def test_without_a_curve_there_is_nothing_to_draw(self, tmp_path: Path) -> None:
        with pytest.raises(NotCalibratedError, match="no face"):
            plot_draft(tmp_path / "a.png", self.photo, estimate_of(self.photo, "face"), SETTINGS)
