"""What was chosen of how to estimate, and estimating so."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import click

from facecrf_ocio.estimators import JOINT_NAMES
from facecrf_ocio.files.threads import beside
from facecrf_ocio.settings import Settings

if TYPE_CHECKING:
    from facecrf_ocio.together import Together
    from facecrf_ocio.values import Estimate, Photo


@dataclass(frozen=True, slots=True)
class Choices:
    """How to estimate, as all commands that estimate take it."""

    estimator: str
    fallback: str
    prior: str
    min_confidence: str
    max_error: float | None
    per_channel: bool | None
    overwrite: bool
    verbose: bool = False

    def __post_init__(self) -> None:
        if self.per_channel and self.estimator in JOINT_NAMES:
            raise click.UsageError(
                f"--per-channel: the estimator {self.estimator} gives one curve for all channels; "
                "leave it out, or choose another --estimator"
            )

    @property
    def settings(self) -> Settings:
        """The default settings, changed as asked."""
        return Settings(shared_curve=self.per_channel is False)

    def read(self, path: Path) -> Photo:
        """Read one photo."""
        from facecrf_ocio import read_photo

        return read_photo(path)

    def read_and_estimate(self, path: Path) -> tuple[Photo, Estimate]:
        """Read one photo and estimate its curve."""
        with beside(self._prepare):
            photo = self.read(path)
        return photo, self.estimate(photo)

    def _prepare(self) -> None:
        """Load what estimating needs: while a photo is decoded, Python has nothing to do."""
        from facecrf_ocio.files.versions import versions

        if self.estimator in JOINT_NAMES:
            import numpy.ma  # NumPy imports both when a quantile, and noise, are first asked for
            import numpy.random  # noqa: F401

            from facecrf_ocio import calibrate as calibrate  # noqa: PLC0414 - loads its module
            from facecrf_ocio.cameras.known_cameras import shipped_cameras
            from facecrf_ocio.face.landmarks import landmark_network
            from facecrf_ocio.face.yunet import yunet_detector
            from facecrf_ocio.joint import shipped_joint

            for load in (shipped_joint, landmark_network, yunet_detector, shipped_cameras):
                load()
        versions()

    def estimate(self, photo: Photo) -> Estimate:
        """Estimate the curve of a photo."""
        from facecrf_ocio import calibrate
        from facecrf_ocio.record.demand import Demand, demand

        estimate = calibrate(
            photo,
            estimator=self.estimator,
            fallback=self.fallback,
            prior=self.prior,
            settings=self.settings,
        )
        return demand(estimate, Demand(self.min_confidence, self.max_error))

    def estimate_together(self, paths: tuple[Path, ...]) -> Together:
        """One curve from all photos, which one camera took."""
        from dataclasses import replace

        from facecrf_ocio import calibrate_together, read_photo
        from facecrf_ocio.record.demand import Demand, demand

        photos = (read_photo(path) for path in paths)
        together = calibrate_together(photos, prior=self.prior, settings=self.settings)
        least = Demand(self.min_confidence, self.max_error)
        return replace(together, estimate=demand(together.estimate, least))
