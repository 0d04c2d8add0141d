"""Reasons without what is peculiar to one photo, so that photos with one fault stand together."""

from __future__ import annotations

import re
from collections.abc import Iterable

# What follows in parentheses where it quotes a library, a path or a name.
_QUOTED = re.compile(r"""\s*\((?=[^()]*["'/:\\])(?:[^()]|\([^()]*\))*\)""")
_NAME = re.compile(r"""(["'])[^"']*\1""")
_NUMBER = re.compile(r"(?<![\w.-])\d+(?:\.\d+)?(?![\w-])")


def reason_kind(reason: str) -> str:
    """Return a reason with names, numbers and what libraries say left out."""
    return _NUMBER.sub("…", _NAME.sub("…", _QUOTED.sub("", reason)))


def reason_kinds(reasons: Iterable[str]) -> list[str]:
    """Return each reason's kind, or the reason itself where it is the only one of its kind."""
    reasons = list(reasons)
    members: dict[str, set[str]] = {}
    for reason in set(reasons):
        members.setdefault(reason_kind(reason), set()).add(reason)
    kinds = {reason: reason_kind(reason) for reason in set(reasons)}
    return [kinds[reason] if len(members[kinds[reason]]) > 1 else reason for reason in reasons]
