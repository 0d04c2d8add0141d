"""Who works on a job's photos: processes of this machine, or a cluster's."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias, Union

from facecrf_ocio.archive.job import Job
from facecrf_ocio.archive.work.processes import Workers

if TYPE_CHECKING:
    from facecrf_ocio.archive.work.dask_cluster import ClusterWorkers

AnyWorkers: TypeAlias = Union[Workers, "ClusterWorkers"]


def workers_of(job: Job) -> AnyWorkers:
    """Workers for a job, to be used as a context manager."""
    if job.cluster is None:
        return Workers(job.jobs, job.limits)
    from facecrf_ocio.archive.work.dask_cluster import ClusterWorkers  # noqa: PLC0415 - heavy

    return ClusterWorkers(job.cluster, job.limits, job.folder)
