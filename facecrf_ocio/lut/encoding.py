"""Ways in which formats hold a response, from linear light to code values."""

from __future__ import annotations

from enum import Enum


class Encoding(Enum):
    """How a format holds the way from linear light back to code values."""

    EXACT = "the linearizing table, marked as to be inverted"
    HALF_DOMAIN = "an entry for each half float"
    UNIFORM = "65536 uniform entries"
    NONE = "not at all"
