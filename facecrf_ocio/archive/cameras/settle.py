"""Between gathering and writing: whose curve each photo of a camera gets.

A camera is concluded again only if its photos changed, and of its photos only those are written
again whose curve changed. All that is decided of one camera is recorded in one transaction.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from facecrf_ocio.archive.cameras.bracket import find_brackets
from facecrf_ocio.archive.cameras.camera_group import (
    CameraCurve,
    bracket_estimate,
    conclude_camera,
    curve_json,
    estimate_sha256,
    evidence_of,
    exposures,
    solve,
)
from facecrf_ocio.archive.manifest.database import DONE, GATHERED, STARTED, Manifest
from facecrf_ocio.archive.work.task import Result
from facecrf_ocio.joint import misfit
from facecrf_ocio.pair.debevec import rmse_after_scale
from facecrf_ocio.together import MISFIT_LIMIT

Reopened = Callable[[str, Result], None]
_PAGE = 500


@dataclass(frozen=True, slots=True)
class _Member:
    """A photo of a camera, as the manifest has it."""

    name: str
    sha256: str
    state: str
    curve: str
    curve_sha256: str
    misfit: float
    outcome: str
    verdict: str


def settle(manifest: Manifest, recipe: str, prior: str, reopened: Reopened) -> None:
    """Conclude the curve of every camera whose photos changed.

    Parameters
    ----------
    manifest
        Its photos of this recipe have all been looked at.
    recipe
        Hash of it.
    prior
        As for `calibrate`.
    reopened
        Called with the name and the former result of a photo that was done and must be written
        again.
    """
    keys = [
        key
        for (key,) in manifest.rows(
            "SELECT DISTINCT camera FROM photos WHERE camera != '' AND recipe = ? ORDER BY 1",
            recipe,
        )
    ]
    for key in keys:
        basis, members, alone = _basis(manifest, key, recipe)
        former = next(
            manifest.rows("SELECT basis, curve_sha256 FROM cameras WHERE key = ?", key), ("", "")
        )
        if former[0] != basis or _has_new(manifest, key, recipe):
            curve = conclude_camera(manifest, key, recipe, prior)
            with manifest.transaction():
                camera = _Camera(manifest, key, recipe, curve, alone, former[1], reopened)
                camera.record(basis, members)
    _forget_the_empty(manifest)


def _basis(manifest: Manifest, key: str, recipe: str) -> tuple[str, int, bool]:
    """Hash of the photos of a camera, their number, and whether all have the same bytes."""
    digest, count, first, alone = hashlib.sha256(recipe.encode()), 0, "", True
    for name, sha256 in manifest.rows(
        "SELECT name, sha256 FROM photos WHERE camera = ? AND recipe = ? AND state != ? "
        "ORDER BY name",
        *(key, recipe, STARTED),
    ):
        digest.update(f"{name}\0{sha256}\0".encode())
        first = first or sha256
        alone = alone and sha256 == first
        count += 1
    return digest.hexdigest(), count, alone


def _has_new(manifest: Manifest, key: str, recipe: str) -> bool:
    """Whether a photo of a camera has no curve assigned, gathered again perhaps."""
    found = manifest.rows(
        "SELECT 1 FROM photos WHERE camera = ? AND recipe = ? AND state = ? AND curve = '' LIMIT 1",
        *(key, recipe, GATHERED),
    )
    return next(found, None) is not None


def _forget_the_empty(manifest: Manifest) -> None:
    with manifest.transaction():
        manifest.change(
            "DELETE FROM cameras WHERE NOT EXISTS "
            "(SELECT 1 FROM photos WHERE photos.camera = cameras.key)"
        )
        manifest.change("DELETE FROM brackets WHERE camera NOT IN (SELECT key FROM cameras)")


class _Camera:
    """One camera that is concluded anew."""

    def __init__(
        self,
        manifest: Manifest,
        key: str,
        recipe: str,
        curve: CameraCurve,
        alone: bool,
        former: str,
        reopened: Reopened,
    ) -> None:
        self.manifest, self.key, self.recipe, self.curve = manifest, key, recipe, curve
        self.alone = alone
        self.same = former == curve.sha256
        self.reopened = reopened
        self.of_bracket: dict[str, tuple[str, str]] = {}  # sha256 -> bracket, hash of its curve
        self.telling = self.misfits = 0

    def record(self, basis: str, members: int) -> None:
        self._record_brackets()
        for member in self._members():
            self._record_member(member)
        estimate = self.curve.estimate
        told = None if estimate is None else estimate.confidence
        shown = ""
        if estimate is not None and told is not None:
            shown = curve_json(estimate.curve, told.sigma)
        self.manifest.change(
            f"INSERT OR REPLACE INTO cameras VALUES ({', '.join('?' * 16)})",  # noqa: S608
            *(self.key, *json.loads(self.key), self.recipe, members),
            *(self.telling, self.curve.used, self.misfits, basis),
            "" if told is None else str(told.verdict),
            "no photo of it says anything" if estimate is None else estimate.reason,
            *(shown, self.curve.sha256),
        )

    def _record_brackets(self) -> None:
        self.manifest.change("DELETE FROM brackets WHERE camera = ?", self.key)
        camera = self.curve.estimate
        for found in find_brackets(exposures(self.manifest, self.key, self.recipe)):
            solved = solve(found)
            estimate = bracket_estimate(found, solved, camera)
            digest = "" if estimate is None else estimate_sha256(estimate)
            error = -1.0
            if solved.found is not None and camera is not None:
                error = rmse_after_scale(solved.found, camera.curve)
            self.manifest.change(
                f"INSERT INTO brackets VALUES ({', '.join('?' * 13)})",  # noqa: S608
                *(found[0].name, self.key, len(found), solved.stops),
                *(int(estimate is not None), solved.problem, solved.halves, solved.bend),
                *(solved.residual, solved.covered, error),
                *(curve_json(solved.found, solved.sigma), digest),
            )
            self.of_bracket.update({one.sha256: (found[0].name, digest) for one in found})

    def _members(self) -> Iterator[_Member]:
        """All photos of the camera, page by page, because they are changed meanwhile."""
        last = ""
        while True:
            page = list(
                self.manifest.rows(
                    "SELECT name, sha256, state, curve, curve_sha256, misfit, outcome, verdict "
                    "FROM photos WHERE camera = ? AND recipe = ? AND state != ? AND name > ? "
                    "ORDER BY name LIMIT ?",
                    *(self.key, self.recipe, STARTED, last, _PAGE),
                )
            )
            yield from (_Member(*row) for row in page)
            if len(page) < _PAGE:
                return
            last = page[-1][0]

    def _record_member(self, member: _Member) -> None:
        distance = self._misfit(member)
        self.telling += distance >= 0.0
        self.misfits += distance > MISFIT_LIMIT
        bracket, bracket_curve = self.of_bracket.get(member.sha256, ("", ""))
        if bracket_curve:
            wanted = ("bracket", bracket_curve)
        elif self.curve.estimate is None or self.alone or distance > MISFIT_LIMIT:
            wanted = ("own", "")
        else:
            wanted = ("camera", self.curve.sha256)
        state = member.state
        if (member.curve or "own", member.curve_sha256) != wanted and state == DONE:
            self.reopened(member.name, Result(member.outcome, member.verdict))
            state = GATHERED
        curve = member.curve if state == DONE else wanted[0]
        self.manifest.change(
            "UPDATE photos SET misfit = ?, bracket = ?, state = ?, curve = ?, curve_sha256 = ? "
            "WHERE name = ?",
            *(distance, bracket, state, curve, wanted[1], member.name),
        )

    def _misfit(self, member: _Member) -> float:
        """Distance from the camera's curve; known already if that is what it was."""
        if self.same and member.curve:
            return member.misfit
        evidence = evidence_of(self.manifest, member.name)
        if not evidence.messages or self.curve.estimate is None:
            return -1.0
        return misfit(evidence, self.curve.estimate)
