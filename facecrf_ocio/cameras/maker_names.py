"""What people call a camera: files spell one maker in many ways."""

from __future__ import annotations

from collections.abc import Iterable


def maker_of(make: str) -> str:
    """What all spellings of a maker share, `nikon` of `NIKON CORPORATION`: their first word."""
    return (make.casefold().split() or [""])[0]


def one_spelling(makes: Iterable[str]) -> dict[str, str]:
    """The spelling of each maker, by `maker_of`: of those given the shortest, in mixed case."""
    return {maker_of(make): make for make in sorted(makes, key=_preferred, reverse=True)}


def camera_name(make: str, model: str) -> str:
    """Make and model, the maker once, in the spelling of the make."""
    return f"{make} {bare_model(make, model)}".strip()


def bare_model(make: str, model: str) -> str:
    """The model without its maker, with whom many models begin, in whatever case."""
    first, _, rest = model.partition(" ")
    return rest if rest and first.casefold() == maker_of(make) else model


def _preferred(make: str) -> tuple[int, bool, str]:
    """Order from the spelling that is taken on."""
    return len(make), make.islower() or make.isupper(), make
