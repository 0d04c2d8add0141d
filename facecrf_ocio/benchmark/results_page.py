"""The page of results, assembled from the folders that benches wrote."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from facecrf_ocio.benchmark import consistency, cue_shares, stress_tables, tables
from facecrf_ocio.errors import PhotoError

_TABLES = {
    "stress.md": "What photos go through",
    "consistency.md": "Real photos, without a truth",
    "table.md": "Synthetic photos (Table 1)",
    "cues.md": "The cues of joint",
    "ablations.md": "Ablations",
}
_PAIRS = "Real cameras (Table 2)"
_RECORDS = {
    "stress.md": "stress.json",
    "consistency.md": "consistency.json",
    "table.md": "results.json",
    "cues.md": "cues.json",
    "ablations.md": "ablations.json",
}
_LEGENDS = (stress_tables.LEGEND, consistency.LEGEND, tables.LEGEND, cue_shares.LEGEND)
_PICTURES = {
    "fig2_gamma.png": "Energies over candidate gammas, for cameras of gamma 0.3 to 1 (Fig. 2). "
    "With exact log ratios a common exponent only scales the matrices of eq. 16, so that E_p can "
    "hardly see it: the differences shown are those of noise.",
    "fig3_highlights.png": "Energies over candidate gammas and strengths of highlights (Fig. 3).",
    "fig4_skin.png": "Skin region, map C of single-pigment changes, hues (Fig. 4).",
    "fig7_curves.png": "Estimates beside the truth (Fig. 7); dashed where the photo has no "
    "evidence. The joint estimator is as it ships, and its training saw such heads and responses: "
    "how far it is off on others is in the tables. Head: Infinite, 3D Head Scan by Lee "
    "Perry-Smith, CC BY 3.0, www.triplegangers.com / www.ir-ltd.net.",
}


def results_page(folders: Sequence[Path], findings: str, pictures: str) -> tuple[str, list[Path]]:
    """Assemble tables, pictures and findings into Markdown.

    Parameters
    ----------
    folders
        As `facecrf bench synthetic`, `ablations` and `figures` wrote them.
    findings
        Markdown that stands before the tables.
    pictures
        Folder, relative to the page, from which it shows the pictures.

    Returns
    -------
    tuple
        The page, and the pictures it shows.

    Raises
    ------
    PhotoError
        If a folder holds no results.
    """
    parts, shown = ["# Results", findings.strip()] if findings.strip() else ["# Results"], []
    explained: set[str] = set()
    for folder in folders:
        found = [name for name in _TABLES if (folder / name).is_file()]
        drawn = [name for name in _PICTURES if (folder / name).is_file()]
        if not found and not drawn:
            raise PhotoError(folder, "holds no results of a bench", "run facecrf bench first")
        for name in found:
            text = _unexplained((folder / name).read_text(encoding="utf-8"), explained)
            run = json.loads((folder / _RECORDS[name]).read_text(encoding="utf-8"))["run"]
            title = _PAIRS if "pairs" in run else _TABLES[name]
            parts += [f"## {title}: {_photos(run)}", text, _conditions(run)]
        for name in drawn:
            parts += [f"![{name}]({pictures}/{name})", _PICTURES[name]]
            shown.append(folder / name)
    return "\n\n".join(parts) + "\n", shown


def _unexplained(text: str, explained: set[str]) -> str:
    """A table without the legends that stood under an earlier one."""
    for legend in _LEGENDS:
        if legend in text and legend in explained:
            text = text.replace(f"{legend}\n", "")
        elif legend in text:
            explained.add(legend)
    return text.strip()


def _photos(run: dict[str, Any]) -> str:
    """What was measured on."""
    if "pairs" in run:
        return f"pairs of exposures, {len(run['pairs'])} in all"
    if "responses" not in run:
        return f"{run['photos']} photos"
    images = list(run["images"])
    named = images[0] if len(images) == 1 else f"{len(images)} images, {images[0]} to {images[-1]},"
    responses = run["responses"]
    rows = responses["rows"]
    which = f"row {rows[0]}" if len(rows) == 1 else f"rows {rows[0]}, {rows[1]} to {rows[-1]}"
    return f"{named} through {len(rows)} responses of {responses['file']} ({which})"


def _conditions(run: dict[str, Any]) -> str:
    """Say in one line how it was run."""
    if "encoding" not in run:
        seed = f"Seed {run['seed']}; code" if "seed" in run else "Code"
        return f"{seed} {run['code'][:12]}."
    encoding = ", ".join(f"{name} {value}" for name, value in run["encoding"].items() if value)
    prior = run.get("prior", "auto")
    return f"Measured with {encoding}; seed {run['seed']}; prior {prior}; code {run['code'][:12]}."
