"""Which edge patches to keep where a photo has more than are needed (Lin et al., CVPR 2004).

A good set covers the range of code values in every channel, has strong contrasts, and regions of
little noise. The paper searches for it at random; here the search is a deterministic one, from the
best patches on, swapping one for another as long as the set gets better.
"""

from __future__ import annotations

import numpy as np

from facecrf_ocio.published.edge_patches import EdgePatch
from facecrf_ocio.values import Float

MAX_PATCHES = 120  # that are kept; the energy takes time in proportion
CODE_BINS = 20  # ranges of code values that the set should cover
DEVIATION_COST = 10.0  # contrast that one unit of noise within the regions takes away


def select_patches(patches: list[EdgePatch], count: int = MAX_PATCHES) -> list[EdgePatch]:
    """At most `count` patches, by local search over swaps; the same for the same photo.

    Parameters
    ----------
    patches
        Best first, as `find_edge_patches` returns them.
    count
        How many to keep.
    """
    if len(patches) <= count:
        return patches
    codes = np.array([_codes(patch) for patch in patches])
    worth = np.array([p.contrast - DEVIATION_COST * p.deviation for p in patches])
    chosen = np.arange(len(patches)) < count
    for _ in range(count):
        total = codes[chosen].sum(axis=0)
        inside, outside = np.flatnonzero(chosen), np.flatnonzero(~chosen)
        loss = worth[inside] + _coverage(total) - _coverage(total - codes[inside])
        least = inside[np.argmin(loss)]
        rest = total - codes[least]
        gain = worth[outside] + _coverage(rest + codes[outside]) - _coverage(rest)
        if gain.max() <= loss.min():
            break
        chosen[[least, outside[np.argmax(gain)]]] = False, True
    return [patch for patch, keep in zip(patches, chosen, strict=True) if keep]


def _codes(patch: EdgePatch) -> Float:
    """Which code ranges of each channel a patch has (3 * CODE_BINS,), 1 or 0."""
    colors = np.concatenate([patch.regions, patch.blends])
    bins = np.clip((colors * CODE_BINS).astype(np.intp), 0, CODE_BINS - 1)
    present = np.zeros((3, CODE_BINS))
    present[np.arange(3), bins] = 1.0
    return present.ravel()


def _coverage(counts: Float) -> Float:
    """Coverage by counts (..., B): each further patch in a code range adds less."""
    return np.asarray(np.log1p(counts).sum(axis=-1))
