"""What came of an archive's photos, recorded in its manifest and told."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from facecrf_ocio.archive.job import Event
from facecrf_ocio.archive.manifest.database import DONE, GATHERED, UNSEEN, Manifest, Stamp
from facecrf_ocio.archive.manifest.summary_rows import keep_for_report
from facecrf_ocio.archive.place import Place
from facecrf_ocio.archive.task import Result, Task


@dataclass(frozen=True, slots=True)
class Begun:
    """A photo at work, as it was when it was handed out; its fingerprint as `content` has it."""

    stamp: Stamp
    fingerprint: str


class Recording:
    """Records and tells what came of photos that are treated by one recipe."""

    def __init__(
        self,
        place: Place,
        manifest: Manifest,
        recipe_sha256: str,
        tell: Callable[[Event], None],
    ) -> None:
        self.place, self.manifest = place, manifest
        self.recipe_sha256, self.tell = recipe_sha256, tell

    def unseen(self, name: str, result: Result) -> None:
        """List what cannot be looked at; what is known of it from before stays as it is."""
        if self.manifest.known(name) is None:
            self._until_next(name, result)

    def _until_next(self, name: str, result: Result) -> None:
        """List a failure that the next run tries anew."""
        with self.manifest.transaction():
            self.manifest.finish(name, Stamp(UNSEEN, 0, self.recipe_sha256), result)
        self.tell(Event(name, result, fresh=True))

    def hindered(self, task: Task, problem: Result) -> None:
        """Tell why outputs cannot be written; what was made of the photo before stays."""
        known = self.manifest.known(task.name)
        if known is None or (known.state == DONE and not self.manifest.outputs(task.name)):
            self._until_next(task.name, problem)
        else:
            self.tell(Event(task.name, problem, fresh=True))

    def looked_at(self, task: Task, begun: Begun, result: Result) -> None:
        """Record what came of a photo that was looked at."""
        if result.gathered is not None:
            with self.manifest.transaction():
                self.manifest.record_gathered(task.name, begun.stamp, result, begun.fingerprint)
                keep_for_report(self.manifest, task.name, result)
            self.tell(Event(task.name, result, fresh=True, step=GATHERED))
            return
        stamp = begun.stamp if result.lasting else Stamp(UNSEEN, 0, self.recipe_sha256)
        self._remove_former(task, result)
        with self.manifest.transaction():
            self.manifest.finish(task.name, stamp, result, begun.fingerprint)
            keep_for_report(self.manifest, task.name, result)
        self.tell(Event(task.name, result, fresh=True))

    def written(self, task: Task, result: Result) -> None:
        """Record that a photo got the curve that was decided."""
        self._remove_former(task, result)
        with self.manifest.transaction():
            self.manifest.written(task.name, result)
            keep_for_report(self.manifest, task.name, result)
        self.tell(Event(task.name, result, fresh=True))

    def _remove_former(self, task: Task, result: Result) -> None:
        # Before the row, so that a run that is cut here finds them in its own unfinished row.
        own = {output.name for output in result.outputs}
        former = {output.name for output in self.manifest.outputs(task.name)}
        self.place.remove(former - own)
