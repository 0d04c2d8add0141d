"""What a batch tells while it runs, and at its end."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from time import monotonic
from typing import TYPE_CHECKING

from facecrf_ocio.archive.walk import Passed, as_utf8
from facecrf_ocio.cli.live import Bar, in_words
from facecrf_ocio.cli.terminal import say
from facecrf_ocio.errors import in_options
from facecrf_ocio.files.plain_text import counted, one_line
from facecrf_ocio.settings import VERDICTS

if TYPE_CHECKING:
    from facecrf_ocio.archive.job import Event

KINDS = (*reversed(VERDICTS), "no curve", "failed")
_PLAIN_EVERY = 30.0  # [s] between two lines where there is no terminal
_MOST_TOLD = 8  # kinds of files that are no photos, links; the others are counted


class Progress:
    """Rate, time left and counts: a live line on a terminal, a plain one now and then elsewhere."""

    def __init__(self, total: int | None, passed: Passed, tell: Callable[[Event], None]) -> None:
        self.total, self.counts, self.passed = total, Counter[str](), passed
        self.tell, self.brackets = tell, Counter[str]()
        self.done = self.fresh = self.gathered = self.failed_before = 0
        self.begin = self.said = monotonic()
        self.bar = Bar()

    def __enter__(self) -> Progress:
        self.bar.__enter__()
        self.bar.show(self._line(), 0, self.total)
        return self

    def __exit__(self, kind: object, *_: object) -> None:
        self.bar.__exit__()
        if self.done or self.gathered or kind is None:  # else the error alone says it all
            for line in (*_passed_over(self.passed), self._line()):
                say(line, err=True)
            if self.failed_before:
                again = counted(self.failed_before, "photo")
                say(f"{again} failed in an earlier run; --retry tries again", err=True)

    def __call__(self, event: Event) -> None:
        """Count what came of a photo, and tell it if it failed."""
        result = event.result
        self.tell(event)
        if event.step == "gathered":
            self.gathered += 1
        elif event.step == "bracket":
            self.brackets[result.outcome] += 1
        else:
            by = -1 if event.step == "reopened" else 1
            self.done += by
            self.fresh += event.fresh
            self.failed_before += not event.fresh and result.outcome == "failed"
            self.counts[kind_of(result.outcome, result.verdict)] += by
        if event.fresh and result.outcome == "failed":
            self.bar.say(f"facecrf: {one_line(_failure(event))}")
        if self.bar:
            self.bar.show(self._line(), self.done, self.total)
        elif monotonic() - self.said > _PLAIN_EVERY:
            self.said = monotonic()
            say(self._line(), err=True)

    def _line(self) -> str:
        if self.total == 0 and not self.done:
            return "no photos found"
        rate = self.fresh / max(monotonic() - self.begin, 1e-9)
        photos = counted(self.done if self.total is None else self.total, "photo")
        text = photos if self.total is None else f"{self.done} of {photos}"
        if self.gathered and (self.total is None or self.done < self.total):
            text = f"{self.gathered} looked at, {text}"
        if self.done > self.fresh:
            text += f" ({self.done - self.fresh} done before)"
        if self.fresh:
            text += f", {rate:.2f}/s"
            if self.total is not None and self.total > self.done:
                text += f", {in_words((self.total - self.done) / rate)} left"
        kinds = ", ".join(f"{self.counts[kind]} {kind}" for kind in KINDS)
        merged = ", ".join(f"{self.brackets[kind]} {kind}" for kind in sorted(self.brackets))
        return f"{text}: {kinds}" + (f"; brackets: {merged}" if merged else "")


def _passed_over(passed: Passed) -> Iterator[str]:
    """What was not looked at, a line for folders, one for links to some and one for files."""
    if passed.folders:
        names = ", ".join(f"{name} ({count})" for name, count in sorted(passed.folders.items()))
        yield one_line(f"passed over folders of other software: {as_utf8(names)}; --all-folders")
    if passed.links:
        some = ", ".join(name for name, _ in passed.links.most_common(_MOST_TOLD))
        links = f"{counted(passed.links.total(), 'link')} to folders: {as_utf8(some)}"
        yield one_line(f"not followed, {links}; run batch on what they lead to")
    if passed.suffixes:
        most = passed.suffixes.most_common(_MOST_TOLD)
        rest = len(passed.suffixes) - len(most)
        told = [f"{count} {suffix or 'without a suffix'}" for suffix, count in most]
        more = [f"{rest} other kinds"] if rest else []
        listed = ", ".join((*told, *more))
        yield one_line(f"not looked at, by their names: {as_utf8(listed)}; --include takes them")


def _failure(event: Event) -> str:
    """Which photo, what is wrong and what to do."""
    told = f"{as_utf8(event.name)}: failed: {event.result.reason}"
    return "; ".join(filter(None, (told, in_options(event.result.remedy))))


def kind_of(outcome: str, verdict: str) -> str:
    """One of `KINDS`."""
    return "failed" if outcome == "failed" else verdict or "no curve"
