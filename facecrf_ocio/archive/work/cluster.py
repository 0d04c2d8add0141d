"""An existing Dask cluster: reached, and refused where its workers are unlike this machine."""

from __future__ import annotations

import logging
import os
from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from facecrf_ocio.errors import ClusterError, SettingsError
from facecrf_ocio.files.plain_text import plain_text
from facecrf_ocio.files.versions import difference

if TYPE_CHECKING:
    from distributed import Client

LARGEST = 1 << 30  # [byte] a larger file is worked on here rather than held in memory and shipped
_REACH = 5.0  # [s] to reach the scheduler
_FIRST = 15.0  # [s] until a first worker must be there


@dataclass(frozen=True, slots=True)
class Cluster:
    """An existing Dask cluster.

    Attributes
    ----------
    address
        Of its scheduler, such as `tcp://host:8786`.
    ship
        Send photos to the workers and write here what comes back; or let the workers read and
        write the client's paths. None: the latter, until a worker does not see them.
    ca, certificate, key
        Files in PEM for a scheduler that speaks TLS alone (`tls://host:8786`): the authority's
        certificate, and the client's own with its key. All are given, or none.
    """

    address: str
    ship: bool | None = None
    ca: str = ""
    certificate: str = ""
    key: str = ""


def connect(cluster: Cluster, open_: ExitStack) -> Client:
    """Reach the scheduler and a first worker; what is to be undone goes onto the stack.

    Raises
    ------
    SettingsError
        If a file of the certificates cannot be read.
    ClusterError
        If no scheduler answers, or it has no workers.
    """
    import dask  # noqa: PLC0415 - an extra
    from distributed import Client  # noqa: PLC0415

    # Its warnings tell of what is told here in our own words, or survived.
    for name in ("distributed", "tornado.application", *logging.root.manager.loggerDict):
        if name.startswith(("distributed", "tornado")):
            logger = logging.getLogger(name)
            open_.callback(logger.setLevel, logger.level)
            logger.setLevel(logging.CRITICAL + 1)
    open_.enter_context(
        dask.config.set({"distributed.admin.large-graph-warning-threshold": LARGEST * 2})
    )
    address = cluster.address
    try:
        client = Client(
            address,
            timeout=_REACH,
            set_as_default=False,
            name="facecrf",
            security=_security(cluster),
        )
    except (OSError, ValueError, TypeError) as error:
        speaks = "" if cluster.ca else ", and whether it speaks TLS alone (ca=...)"
        raise ClusterError(
            f"{address}: no Dask scheduler answers there; start one with `dask scheduler`, or "
            f"check the address{speaks}"
        ) from error
    open_.callback(client.close, timeout=_REACH)
    try:
        client.wait_for_workers(1, timeout=_FIRST)
    except TimeoutError:
        raise ClusterError(
            f"{address}: has no workers; start some with `dask worker {address}`"
        ) from None
    return client


def _security(cluster: Cluster) -> Any:
    """What the client shows and asks for; None without TLS."""
    from distributed import Security  # noqa: PLC0415 - an extra

    if not cluster.ca:
        return None
    for path in (cluster.ca, cluster.certificate, cluster.key):
        if not os.access(path, os.R_OK):
            raise SettingsError(f"{path}: cannot be read; name a file in PEM")
    return Security(
        tls_ca_file=cluster.ca,
        tls_client_cert=cluster.certificate,
        tls_client_key=cluster.key,
        require_encryption=True,
    )


def require_equal_workers(client: Client, own: Mapping[str, str]) -> frozenset[str]:
    """Kinds of the workers' processors; ClusterError where one has other versions than `own`."""
    kinds = set()
    for worker, there in client.run(_asker(), on_error="return").items():
        if isinstance(there, dict):
            kinds.add(plain_text(there.pop("processor", "")))
        if not isinstance(there, dict):
            problem = f"facecrf-ocio cannot be imported there ({there})"
        else:
            problem = difference(own, there)
        if problem:
            raise ClusterError(unlike(worker, problem))
    return frozenset(kinds)


def unlike(worker: str, problem: str) -> str:
    """What is wrong with a worker of other versions, and what to do."""
    return f"{worker}: {problem}; install the same versions on all machines, outputs differ"


def _asker() -> Any:
    """A function that travels as code, so that a worker without this package can answer, too."""

    def told() -> dict[str, str] | str:
        try:
            from facecrf_ocio.files.processor import processor  # noqa: PLC0415
            from facecrf_ocio.files.versions import versions  # noqa: PLC0415
        except ImportError as error:
            return str(error)
        return {**versions(), "processor": processor()}

    return told
