"""What people call a camera: files spell one maker in many ways."""

from __future__ import annotations

from collections.abc import Iterable


def maker_of(make: str) -> str:
    """What all spellings of a maker share, `nikon` of `NIKON CORPORATION`: their first word."""
    return (make.casefold().split() or [""])[0]


def one_spelling(makes: Iterable[str]) -> dict[str, str]:
    """The spelling of each maker, by `maker_of`: of those given the shortest, in mixed case."""
    return {maker_of(make): make for make in sorted(makes, key=_preferred, reverse=True)}


def camera_name(maker: str, model: str) -> str:
    """Maker and model, the maker once: many models begin with it, in whatever case."""
    first, _, rest = model.partition(" ")
    bare = rest if rest and first.casefold() == maker_of(maker) else model
    return f"{maker} {bare}".strip()


def _preferred(make: str) -> tuple[int, bool, str]:
    """Order from the spelling that is taken on."""
    return len(make), make.islower() or make.isupper(), make
