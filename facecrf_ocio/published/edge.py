"""EdgeCRF: the curve that makes color blends at edges straight (Lin et al., CVPR 2004)."""

from __future__ import annotations

from facecrf_ocio.published.answer import Answer, EnergyTerms
from facecrf_ocio.published.edge_patches import find_edge_patches, lacking_patches, stack_blends
from facecrf_ocio.published.edge_selection import select_patches
from facecrf_ocio.published.energy.color_blend import ColorBlend
from facecrf_ocio.published.solve import Weighted
from facecrf_ocio.response.model import ResponseModel
from facecrf_ocio.settings import PublishedSettings
from facecrf_ocio.values import Photo

# lambda of the paper's likelihood exp(-lambda D), with D the sum over all edge pixels.
BLEND_WEIGHT = 1e4


def edge_answer(photo: Photo, model: ResponseModel, settings: PublishedSettings) -> Answer:  # noqa: ARG001
    """Color blends at the photo's edges as a likelihood of curves; the estimator `edge`.

    Parameters
    ----------
    photo
        As read; its pixels must not have been scaled.
    model
        The response model whose grid the curves will be on.
    settings
        Taken for the interface: the paper's own weight is used.
    """
    patches = find_edge_patches(photo.encoded)
    lacking = lacking_patches(photo, len(patches))
    if lacking is not None:
        return lacking
    blends = stack_blends(select_patches(patches))
    return EnergyTerms(
        terms=(Weighted("color blend", BLEND_WEIGHT, ColorBlend(blends, model.grid.size)),),
        encoded=blends.blends.T,
        summary=f"{blends.regions.shape[1]} edge patches with {blends.patch.size} blended pixels",
    )
