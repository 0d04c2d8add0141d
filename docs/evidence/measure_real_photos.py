"""Hold estimates of real photos against measured curves of the cameras that took them.

`python docs/evidence/measure_real_photos.py LIST.tsv -o OUT.csv`. Each line of the list has,
between tabs: a photo's path, a file of responses, a response's name there, and a row of the table.
The curve of green is the truth. The weights are those without the response's maker, where they were
trained with the file, and what is known of the camera's model is not told. Each photo is taken as
it is, and once with nothing in its file.
"""

from __future__ import annotations

import argparse
import csv
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np

from facecrf_ocio import read_photo
from facecrf_ocio.benchmark.chart_cameras import chart_cameras
from facecrf_ocio.benchmark.folds import assign_folds
from facecrf_ocio.benchmark.joint_folds import FOLDS, joint_model
from facecrf_ocio.benchmark.laid_out import markdown_table, number
from facecrf_ocio.benchmark.metrics import Score, score
from facecrf_ocio.benchmark.responses import Responses, read_responses
from facecrf_ocio.benchmark.tables import is_right, mean_of
from facecrf_ocio.benchmark.virtual_camera import count_codes
from facecrf_ocio.cameras.maker_names import maker_of
from facecrf_ocio.color.srgb import decode_srgb
from facecrf_ocio.errors import FaceCRFError
from facecrf_ocio.joint import conclude, gather
from facecrf_ocio.joint.metadata import modern_leaning
from facecrf_ocio.values import Camera, Float, InverseCRF, Photo

GRID = np.linspace(0.0, 1.0, 1024)  # as many as a stored response has
VARIANTS = ("as it is", "nothing in the file")


@dataclass(frozen=True)
class Result:
    """Errors of one estimate, as `metrics.Score` has them, and of the two trivial answers."""

    row: str
    photo: str
    response: str
    variant: str
    answered: bool
    verdict: str
    mid: float
    shadows: float
    used: float | None
    bias: float
    rmse: float
    band: float | None
    expected: float | None
    srgb_mid: float
    srgb_shadows: float
    srgb_rmse: float
    mean_mid: float
    mean_shadows: float
    mean_rmse: float
    face: float
    reason: str


def mean_curve(maker: str) -> Float:
    """(1024,) mean of the charted cameras of all other makers: what to guess without the photo."""
    charts = chart_cameras()
    others = [
        np.sqrt(curve[1])
        for row, curve in enumerate(charts.inverse)
        if maker_of(charts.family(row)) != maker_of(maker)
    ]
    return np.asarray(np.mean(others, axis=0) ** 2)


def measure(photo: Photo, responses: Responses, row: int) -> tuple[dict[str, object], ...]:
    """All columns of `Result` that the photo decides, for each variant."""
    truth = np.repeat(responses.inverse[row][1:2], 3, axis=0)
    model = joint_model(responses, int(assign_folds(responses, FOLDS)[row]))
    counts = count_codes(photo)
    fixed = (decode_srgb(GRID), mean_curve(responses.family(row)))
    srgb, mean = (score(InverseCRF(GRID, np.tile(c, (3, 1))), None, truth, counts) for c in fixed)
    found = []
    evidence = gather(photo, networks=model.networks)
    nobodys = modern_leaning(Camera(), photo.primaries)
    nothing = replace(evidence, leaning=nobodys, phone=0.0, camera=("", ""), adapted=())
    for seen in (evidence, nothing):
        estimate = conclude([seen], "auto", model, cameras=())
        told = estimate.confidence
        errors = score(estimate.curve, told, truth, counts)
        face = 0.0 if evidence.face is None else float(evidence.face.box_xy[2])
        verdict = "" if told is None or not evidence.messages else str(told.verdict)
        expected = None if told is None or told.in_stops is None else told.in_stops.mid
        found.append(
            {
                "answered": bool(evidence.messages),
                "verdict": verdict,
                **_columns(errors),
                "band": errors.band_stops,
                "expected": expected,
                "srgb_mid": srgb.mid,
                "srgb_shadows": srgb.shadows,
                "srgb_rmse": srgb.rmse,
                "mean_mid": mean.mid,
                "mean_shadows": mean.shadows,
                "mean_rmse": mean.rmse,
                "face": face,
                "reason": evidence.doubt or evidence.lacking,
            }
        )
    return tuple(found)


def table(results: Sequence[Result]) -> str:
    """A row for each of the list's rows and each variant; refused photos count as the prior."""
    headings = "photos|64-235: median|mean|95 %|16-64|codes used|RMSE: median|95 %|"
    headings += "nearer than sRGB|band %|reliable|right|refused|"
    headings += "sRGB: 64-235|16-64|RMSE|mean curve: 64-235|16-64|RMSE"
    lines = []
    for row in dict.fromkeys(one.row for one in results):
        for variant in VARIANTS:
            mine = [one for one in results if one.row == row and one.variant == variant]
            lines.append([f"{row}, {variant} ({len(mine)})", *_cells(mine)])
    return markdown_table(headings.split("|"), lines)


def _cells(mine: Sequence[Result]) -> list[str]:
    mid, rmse = np.array([r.mid for r in mine]), 100.0 * np.array([r.rmse for r in mine])
    sure = [r for r in mine if r.verdict == "reliable"]
    right = sum(is_right(r.mid, r.srgb_mid) for r in sure)
    stops = (np.median(mid), mid.mean(), np.quantile(mid, 0.95), mean_of(r.shadows for r in mine))
    trivial = [(r.srgb_mid, r.srgb_shadows, 100 * r.srgb_rmse) for r in mine]
    average = [(r.mean_mid, r.mean_shadows, 100 * r.mean_rmse) for r in mine]
    return [
        *(number(value, 1, 3) for value in (*stops, mean_of(r.used for r in mine))),
        *(number(value, 1, 1) for value in (np.median(rmse), np.quantile(rmse, 0.95))),
        number(mean_of(r.mid < r.srgb_mid for r in mine), 100, 0),
        number(mean_of(r.band for r in mine), 100, 0),
        *(str(value) for value in (len(sure), right, sum(not r.answered for r in mine))),
        *(f"{value:.3g}" for value in (*np.mean(trivial, axis=0), *np.mean(average, axis=0))),
    ]


def _columns(errors: Score) -> dict[str, object]:
    names = ("mid", "shadows", "used", "rmse")
    return {**{name: getattr(errors, name) for name in names}, "bias": errors.bias_stops}


def main() -> None:
    """Read the list, measure, write one line a photo and variant, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("list", type=Path)
    parser.add_argument("-o", "--output", type=Path, required=True)
    asked = parser.parse_args()
    files: dict[str, Responses] = {}
    results = []
    for line in asked.list.read_text(encoding="utf-8").splitlines():
        path, curves, name, row = line.split("\t")
        responses = files.setdefault(curves, read_responses(Path(curves)))
        try:
            photo = read_photo(path)
        except FaceCRFError as error:
            print(error)
            continue
        for variant, columns in zip(
            VARIANTS, measure(photo, responses, responses.names.index(name)), strict=True
        ):
            results.append(Result(row, path, name, variant, **columns))  # type: ignore[arg-type]
        with asked.output.open("w", newline="", encoding="utf-8") as out:
            writer = csv.DictWriter(out, list(asdict(results[0])))
            writer.writeheader()
            writer.writerows(asdict(one) for one in results)
    print(table(results))


if __name__ == "__main__":
    main()
