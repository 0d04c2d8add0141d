"""The page of results, assembled from the folders that benches wrote."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

from facecrf_ocio.errors import PhotoError

_TABLES = {
    "table.md": "Synthetic photos (Table 1)",
    "cues.md": "The cues of joint",
    "ablations.md": "Ablations",
}
_PAIRS = "Real cameras (Table 2)"
_RECORDS = {
    "table.md": "results.json",
    "cues.md": "cues.json",
    "ablations.md": "ablations.json",
}
_PICTURES = {
    "fig2_gamma.png": "Energies over candidate gammas, for cameras of gamma 0.3 to 1 (Fig. 2). "
    "With exact log ratios a common exponent only scales the matrices of eq. 16, so that E_p can "
    "hardly see it: the differences shown are those of noise.",
    "fig3_highlights.png": "Energies over candidate gammas and strengths of highlights (Fig. 3).",
    "fig4_skin.png": "Skin region, map C of single-pigment changes, hues (Fig. 4).",
    "fig7_curves.png": "Estimates beside the truth (Fig. 7). Head: Infinite, 3D Head Scan by Lee "
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
    for folder in folders:
        tables = [name for name in _TABLES if (folder / name).is_file()]
        drawn = [name for name in _PICTURES if (folder / name).is_file()]
        if not tables and not drawn:
            raise PhotoError(folder, "holds no results of a bench", "run facecrf bench first")
        for name in tables:
            text = (folder / name).read_text(encoding="utf-8").strip()
            conditions = _conditions(folder / _RECORDS[name])
            title = _PAIRS if "pairs of exposures" in conditions else _TABLES[name]
            parts += [f"## {title}", text, conditions]
        for name in drawn:
            parts += [f"![{name}]({pictures}/{name})", _PICTURES[name]]
            shown.append(folder / name)
    return "\n\n".join(parts) + "\n", shown


def _conditions(path: Path) -> str:
    """Say in one line what was run."""
    run = json.loads(path.read_text(encoding="utf-8"))["run"]
    if "responses" not in run:
        return f"Measured on {len(run['pairs'])} pairs of exposures; code {run['code'][:12]}."
    responses = run["responses"]
    encoding = ", ".join(f"{name} {value}" for name, value in run["encoding"].items() if value)
    images = list(run["images"])
    named = images[0] if len(images) == 1 else f"{len(images)} images, {images[0]} to {images[-1]},"
    return (
        f"Measured on {named} through {len(responses['rows'])} responses of "
        f"{responses['file']}; {encoding}; seed {run['seed']}; code {run['code'][:12]}."
    )
