"""Responses of real cameras from photos of a color chart, one folder a camera."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from facecrf_ocio.benchmark.chart_cameras import fitted_prior
from facecrf_ocio.chart.calibrate_chart import calibrate_chart
from facecrf_ocio.errors import FaceCRFError
from facecrf_ocio.joint.metadata import phone_leaning
from facecrf_ocio.joint.prior import shipped_prior
from facecrf_ocio.photo.read import read_photo
from facecrf_ocio.response.expected_stops import verdict_of
from facecrf_ocio.response.stops import CODES, MID_CODES, mean_over
from facecrf_ocio.values import Camera, Float, Verdict

_MOST_PHOTOS = 4  # of a folder: more of the same chart say the same
_MOST_APART = 0.05  # [stop] of a camera's photos from their median, or it has several curves
_JPEGS = (".jpg", ".jpeg")


@dataclass(frozen=True, slots=True, eq=False)
class ChartCamera:
    """A camera's green response.

    Attributes
    ----------
    maker, model, kind
        By the names of its folders, and `camera_jpeg` or `phone_isp` by its photos.
    exif
        Make and model that its photos name; empty where they name none.
    linear
        (256,) linear light at uniform code values.
    photos
        Number of those it is the mean of.
    """

    maker: str
    model: str
    kind: str
    exif: tuple[str, str]
    linear: Float
    photos: int


def measure_charts(folder: Path, without: Collection[str] = ()) -> Iterator[ChartCamera]:
    """Measure the cameras below a folder: MAKER/MODEL/.../PHOTO.jpg.

    A camera counts whose photos give reliable curves that agree.

    Parameters
    ----------
    without
        Folders MAKER/MODEL to pass over.
    """
    for place in sorted(path for path in folder.glob("*/*") if path.is_dir()):
        maker, model = place.relative_to(folder).parts
        if f"{maker}/{model}" not in without:
            found = _measured(place, maker, model)
            if found is not None:
                yield found


def store_charts(cameras: Collection[ChartCamera], path: Path) -> None:
    """Write responses as `benchmark.responses.read_responses` reads them."""
    np.savez_compressed(
        path,
        inverse=np.array([one.linear for one in cameras], np.float32),
        names=np.array([f"{one.maker} {one.model}" for one in cameras]),
        maker=np.array([one.maker for one in cameras]),
        kind=np.array([one.kind for one in cameras]),
        exif=np.array([one.exif for one in cameras]),
        photos=np.array([one.photos for one in cameras]),
    )


def _measured(place: Path, maker: str, model: str) -> ChartCamera | None:
    paths = sorted(path for path in place.rglob("*") if path.suffix.lower() in _JPEGS)
    # Not by the prior that these curves are to widen.
    curves, prior, named = [], fitted_prior(shipped_prior()), Camera()
    for path in paths:
        try:
            photo = read_photo(path)
            estimate = calibrate_chart(photo, prior=prior).estimate
        except FaceCRFError:
            continue  # another subject, or a chart that nobody finds
        told = estimate.confidence
        if estimate.found is None or told is None or told.in_stops is None:
            continue
        # Bent curves too: whether the photos of a camera agree is looked at below.
        if verdict_of(told.in_stops) is Verdict.RELIABLE:
            at = np.interp(CODES / CODES[-1], estimate.found.encoded, estimate.found.linear[1])
            curves.append(at)
            named = photo.camera
        if len(curves) == _MOST_PHOTOS:
            break
    if not curves:
        return None
    stops = np.log2(np.maximum(np.array(curves), 1e-6))
    stops -= np.array([mean_over(row, MID_CODES) for row in stops])[:, None]
    away = [mean_over(row, MID_CODES) for row in np.abs(stops - np.median(stops, axis=0))]
    if np.median(away) > _MOST_APART:
        return None
    agreeing = np.array(curves)[np.array(away) <= _MOST_APART]
    linear = np.sqrt(agreeing).mean(axis=0) ** 2
    linear[0], linear[-1] = 0.0, 1.0
    kind = "phone_isp" if phone_leaning(named) > 0.0 else "camera_jpeg"
    return ChartCamera(maker, model, kind, (named.make, named.model), linear, len(agreeing))
