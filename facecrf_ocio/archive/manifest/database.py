"""The manifest of an archive: what is known of every photo, in SQLite, safe against any end.

`schema.py` describes its tables. Names are told as they are; how they are kept is `keys.py`'s.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from facecrf_ocio.archive.manifest.connection import Connection
from facecrf_ocio.archive.manifest.damage import telling, understanding
from facecrf_ocio.archive.manifest.keys import folded, key_of, name_of_key
from facecrf_ocio.archive.manifest.schema import fact, note_fact
from facecrf_ocio.archive.task import Gathered, Output, Result
from facecrf_ocio.archive.walk import as_utf8
from facecrf_ocio.errors import OutputError
from facecrf_ocio.files.plain_text import plain_text

UNSEEN = -1  # [byte] no size of a file
CLAIMED = -1
"""Size of an output that is about to be written: the name is taken, the file may be there."""
STARTED, GATHERED, WRITING, DONE = "started", "gathered", "writing", "done"
_ANEW = "start the batch again, into a new folder"


_COLUMNS = (
    "name, size, mtime_ns, ctime_ns, sha256, recipe, state, outcome, verdict, estimator, reason, "
    "remedy, make, model, serial, software, read_s, estimate_s, write_s, curve, fingerprint"
)


@dataclass(frozen=True, slots=True)
class Stamp:
    """By what a photo is known to be unchanged without reading it, and how it was treated.

    The size is `UNSEEN` where nothing can be known of it. `ctime_ns`, when the file or its
    properties were last changed, is 0 where an older manifest does not tell.
    """

    size: int
    mtime_ns: int
    recipe_sha256: str
    ctime_ns: int = 0


@dataclass(frozen=True, slots=True)
class Known:
    """What the manifest says of a photo."""

    stamp: Stamp
    state: str
    outcome: str
    verdict: str
    sha256: str = ""


class Manifest(Connection):
    """The open manifest: what is recorded of photos and of their outputs, by name."""

    def about(self, key: str) -> str | None:
        """Return a fact about the archive."""
        with telling(self.path):
            return fact(self._base, key)

    def note(self, key: str, value: str) -> None:
        """Record a fact about the archive."""
        with telling(self.path):
            note_fact(self._base, key, value)

    def note_run(self, recipe_sha256: str, recipe: str, processors: Iterable[str]) -> None:
        """Record how photos of a recipe are treated, and on what processors."""
        with understanding(self.path):
            known = {*json.loads(self.about("cpu") or "[]"), *processors}
        self.note(f"recipe {recipe_sha256}", recipe)
        self.note("cpu", json.dumps(sorted(known)))

    def known(self, name: str) -> Known | None:
        """Return what is known of a photo."""
        row = next(
            self.rows(
                "SELECT size, mtime_ns, recipe, ctime_ns, state, outcome, verdict, sha256 "
                "FROM photos WHERE name = ?",
                key_of(name),
            ),
            None,
        )
        return None if row is None else Known(Stamp(*row[:4]), *row[4:])

    def touch(self, name: str, stamp: Stamp) -> None:
        """Record that a photo is the one it was, though its times are not."""
        self.change(
            "UPDATE photos SET mtime_ns = ?, ctime_ns = ? WHERE name = ?",
            *(stamp.mtime_ns, stamp.ctime_ns, key_of(name)),
        )

    def touch_output(self, output: Output) -> None:
        """Record that an output is the one it was, though its time is not."""
        self.change(
            "UPDATE outputs SET written_ns = ? WHERE name = ?",
            *(output.written_ns, key_of(output.name)),
        )

    def start(self, name: str, stamp: Stamp, claimed: Iterable[str] = ()) -> None:
        """Record that from now on the photo's outputs may be half there, and which they are."""
        key = key_of(name)
        self.change(
            "INSERT INTO photos (name, size, mtime_ns, ctime_ns, recipe, state) "
            "VALUES (?, ?, ?, ?, ?, ?) ON CONFLICT (name) DO UPDATE SET state = excluded.state",
            *(key, stamp.size, stamp.mtime_ns, stamp.ctime_ns, stamp.recipe_sha256, STARTED),
        )
        self._claim(key, claimed)

    def writing(self, name: str, claimed: Iterable[str]) -> None:
        """Record that a photo of which the evidence is known may have half of its outputs."""
        self.change("UPDATE photos SET state = ? WHERE name = ?", WRITING, key_of(name))
        self._claim(key_of(name), claimed)

    def _claim(self, key: str, names: Iterable[str]) -> None:
        for name in names:
            self.change(
                "INSERT INTO outputs VALUES (?, ?, ?, '', 0, ?) ON CONFLICT (name) DO NOTHING",
                *(key_of(name), key, CLAIMED, folded(name)),
            )

    def record_gathered(self, name: str, stamp: Stamp, result: Result, fingerprint: str) -> None:
        """Record what a photo says; its outputs wait for the curve of its camera."""
        shot, gathered, key = result.shot, result.gathered, key_of(name)
        if gathered is None:
            raise ValueError(f"{name} says nothing")
        self._replace(key, stamp, result, fingerprint, GATHERED)
        camera = json.dumps([*result.camera, shot.style], ensure_ascii=False)
        self.change(
            "UPDATE photos SET camera = ?, taken = ?, exposure_s = ?, aperture = ?, iso = ? "
            "WHERE name = ?",
            *(camera, shot.taken, shot.exposure_s, shot.aperture, shot.iso, key),
        )
        self.change(
            "INSERT OR REPLACE INTO evidence VALUES (?, ?, ?, ?)",
            *(key, gathered.evidence, gathered.face, gathered.samples),
        )

    def gathered(self, name: str) -> Gathered:
        """Return what a photo says, which `record_gathered` kept.

        Raises
        ------
        OutputError
            If it is not there.
        """
        rows = self.rows(
            "SELECT evidence, face, samples FROM evidence WHERE photo = ?", key_of(name)
        )
        row = next(rows, None)
        if row is None:
            raise OutputError(f"{self.path}: has lost what {as_utf8(name)} says; {_ANEW}")
        return Gathered(*row)

    def written(self, name: str, result: Result) -> None:
        """Record that a photo of which the evidence is known has its outputs."""
        self.change(
            "UPDATE photos SET state = ?, outcome = ?, verdict = ?, estimator = ?, reason = ?, "
            "remedy = ?, write_s = ?, curve = CASE WHEN ? THEN curve ELSE '' END WHERE name = ?",
            *(DONE, result.outcome, result.verdict, result.estimator, plain_text(result.reason)),
            *(plain_text(result.remedy), result.timing.write, bool(result.outputs), key_of(name)),
        )
        self._list_outputs(key_of(name), result.outputs)

    def finish(self, name: str, stamp: Stamp, result: Result, fingerprint: str = "") -> None:
        """Record what came of a photo."""
        key = key_of(name)
        self._replace(key, stamp, result, fingerprint, DONE)
        self.change("DELETE FROM evidence WHERE photo = ?", key)
        self._list_outputs(key, result.outputs)

    def _replace(
        self, key: str, stamp: Stamp, result: Result, fingerprint: str, state: str
    ) -> None:
        self.change(
            f"INSERT OR REPLACE INTO photos ({_COLUMNS}) "  # noqa: S608
            f"VALUES ({', '.join('?' * 21)})",
            *(key, stamp.size, stamp.mtime_ns, stamp.ctime_ns),
            *(result.sha256, stamp.recipe_sha256, state),
            *(result.outcome, result.verdict, result.estimator, plain_text(result.reason)),
            *(plain_text(result.remedy), *map(plain_text, result.camera)),
            *(result.timing.read, result.timing.estimate, result.timing.write),
            *("own" if result.outputs else "", fingerprint if result.sha256 else ""),
        )

    def _list_outputs(self, key: str, outputs: Iterable[Output]) -> None:
        self.change("DELETE FROM outputs WHERE photo = ?", key)
        record_outputs(self, key, outputs)

    def forget(self, name: str) -> None:
        """Take back `start` of a photo that was never done."""
        self.change("DELETE FROM outputs WHERE photo = ? AND size = ?", key_of(name), CLAIMED)
        self.change(
            "DELETE FROM photos WHERE name = ? AND outcome = '' AND state = ?",
            *(key_of(name), STARTED),
        )

    def forget_unseen(self) -> None:
        """Take back what could not be looked at: whether it can be now is to be found out."""
        with self.transaction():
            self.change("DELETE FROM photos WHERE size = ?", UNSEEN)

    def started(self) -> Iterator[str]:
        """Yield the photos whose outputs, or whose bracket's merge, may be half there."""
        rows = self.rows(
            "SELECT name FROM photos WHERE state IN (?, ?) UNION "
            "SELECT name FROM merges WHERE state = ?",
            *(STARTED, WRITING, WRITING),
        )
        return (name_of_key(key) for (key,) in rows)

    def outputs(self, photo: str) -> list[Output]:
        """Return the outputs of a photo, those that are only claimed among them."""
        found = self.rows(
            "SELECT name, size, sha256, written_ns FROM outputs WHERE photo = ?", key_of(photo)
        )
        return [Output(name_of_key(key), *rest) for key, *rest in found]

    def owners(self, output: str) -> list[tuple[str, str]]:
        """Return outputs that differ from this one in case or composition at most, with photos."""
        found = self.rows("SELECT name, photo FROM outputs WHERE folded = ?", folded(output))
        return [(name_of_key(name), name_of_key(photo)) for name, photo in found]

    def counts(self) -> Mapping[tuple[str, str], int]:
        """Return the number of finished photos of each (outcome, verdict)."""
        rows = self.rows(
            "SELECT outcome, verdict, COUNT(*) FROM photos WHERE state = ? GROUP BY 1, 2", DONE
        )
        return {(outcome, verdict): count for outcome, verdict, count in rows}

    def __len__(self) -> int:
        return int(next(self.rows("SELECT COUNT(*) FROM photos"))[0])


def record_outputs(manifest: Manifest, key: str, outputs: Iterable[Output]) -> None:
    """Record outputs of the photo with a key besides its others, within a transaction."""
    for item in outputs:
        manifest.change(
            "INSERT OR REPLACE INTO outputs VALUES (?, ?, ?, ?, ?, ?)",
            *(key_of(item.name), key, item.size, item.sha256, item.written_ns),
            folded(item.name),
        )
