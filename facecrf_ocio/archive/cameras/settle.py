"""Between gathering and writing: whose curve each photo of a camera gets.

A camera is concluded again only if its photos changed, and of its photos only those are written
again whose curve changed. All that is decided of one camera is recorded in one transaction.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import replace

from facecrf_ocio.archive.cameras.bracket import BracketPhoto, find_brackets
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
from facecrf_ocio.archive.manifest.camera_rows import (
    BracketRow,
    CameraRow,
    Member,
    assign,
    camera_keys,
    contents,
    forget_brackets,
    forget_empty_cameras,
    former_curve,
    has_unassigned,
    members,
    record_bracket,
    record_camera,
)
from facecrf_ocio.archive.manifest.damage import understanding
from facecrf_ocio.archive.manifest.database import DONE, GATHERED, Manifest
from facecrf_ocio.archive.manifest.keys import key_of
from facecrf_ocio.archive.task import Recipe, Result
from facecrf_ocio.joint import misfit
from facecrf_ocio.pair.bracket_curve import rmse_after_scale
from facecrf_ocio.together import MISFIT_LIMIT

Reopened = Callable[[str, Result], None]


def settle(manifest: Manifest, recipe_sha256: str, recipe: Recipe, reopened: Reopened) -> None:
    """Conclude the curve of every camera whose photos changed.

    Parameters
    ----------
    manifest
        Its photos of this recipe have all been looked at.
    recipe_sha256
        Hash of it.
    recipe
        What it says of the prior, and of channels.
    reopened
        Called with the name and the former result of a photo that was done and must be written
        again.
    """
    for key in camera_keys(manifest, recipe_sha256):
        with understanding(manifest.path):
            _settle_camera(manifest, key, recipe_sha256, recipe, reopened)
    forget_empty_cameras(manifest)


def _settle_camera(
    manifest: Manifest, key: str, recipe_sha256: str, recipe: Recipe, reopened: Reopened
) -> None:
    basis, count, alone = _basis(manifest, key, recipe_sha256)
    former, digest = former_curve(manifest, key)
    if former != basis or has_unassigned(manifest, key, recipe_sha256):
        curve = conclude_camera(manifest, key, recipe_sha256, recipe)
        with manifest.transaction():
            camera = _Camera(manifest, key, recipe_sha256, curve, alone, digest, reopened)
            camera.record(basis, count)


def _basis(manifest: Manifest, key: str, recipe_sha256: str) -> tuple[str, int, bool]:
    """Hash of the photos of a camera, their number, and whether all have the same bytes."""
    digest, count, first, alone = hashlib.sha256(recipe_sha256.encode()), 0, "", True
    for name, sha256 in contents(manifest, key, recipe_sha256):
        digest.update(f"{key_of(name)}\0{sha256}\0".encode())
        first = first or sha256
        alone = alone and sha256 == first
        count += 1
    return digest.hexdigest(), count, alone


class _Camera:
    """One camera that is concluded anew."""

    def __init__(
        self,
        manifest: Manifest,
        key: str,
        recipe_sha256: str,
        curve: CameraCurve,
        alone: bool,
        former: str,
        reopened: Reopened,
    ) -> None:
        self.manifest, self.key, self.curve = manifest, key, curve
        self.recipe_sha256 = recipe_sha256
        self.alone = alone
        self.same = former == curve.sha256
        self.reopened = reopened
        self.of_bracket: dict[str, tuple[str, str]] = {}  # sha256 -> bracket, hash of its curve
        self.telling = self.misfits = 0

    def record(self, basis: str, count: int) -> None:
        self._record_brackets()
        for member in members(self.manifest, self.key, self.recipe_sha256):
            self._record_member(member)
        estimate = self.curve.estimate
        told = None if estimate is None else estimate.confidence
        shown = ""
        if estimate is not None and told is not None:
            shown = curve_json(estimate.curve, told.sigma)
        record_camera(
            self.manifest,
            CameraRow(
                key=self.key,
                recipe_sha256=self.recipe_sha256,
                members=count,
                telling=self.telling,
                used=self.curve.used,
                misfits=self.misfits,
                basis=basis,
                verdict="" if told is None else str(told.verdict),
                reason="no photo of it says anything" if estimate is None else estimate.reason,
                curve=shown,
                curve_sha256=self.curve.sha256,
            ),
        )

    def _record_brackets(self) -> None:
        forget_brackets(self.manifest, self.key)
        for found in find_brackets(exposures(self.manifest, self.key, self.recipe_sha256)):
            row = self._bracket_row(found)
            record_bracket(self.manifest, row)
            self.of_bracket.update({one.sha256: (row.name, row.curve_sha256) for one in found})

    def _bracket_row(self, found: tuple[BracketPhoto, ...]) -> BracketRow:
        camera, solved = self.curve.estimate, solve(found)
        estimate = bracket_estimate(found, solved, camera)
        error = -1.0
        if solved.found is not None and camera is not None:
            error = rmse_after_scale(solved.found, camera.curve)
        return BracketRow(
            name=found[0].name,
            camera=self.key,
            photos=len(found),
            stops=solved.stops,
            used=estimate is not None,
            reason=solved.problem,
            halves=solved.halves,
            bend=solved.bend,
            residual=solved.residual,
            covered=solved.covered,
            rmse=error,
            curve=curve_json(solved.found, solved.sigma),
            curve_sha256="" if estimate is None else estimate_sha256(estimate),
        )

    def _record_member(self, member: Member) -> None:
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
        assign(
            self.manifest,
            replace(
                member,
                misfit=distance,
                bracket=bracket,
                state=state,
                curve=member.curve if state == DONE else wanted[0],
                curve_sha256=wanted[1],
            ),
        )

    def _misfit(self, member: Member) -> float:
        """Distance from the camera's curve; known already if that is what it was."""
        if self.same and member.curve:
            return member.misfit
        evidence = evidence_of(self.manifest, member.name)
        if not evidence.messages or self.curve.estimate is None:
            return -1.0
        return misfit(evidence, self.curve.estimate)
