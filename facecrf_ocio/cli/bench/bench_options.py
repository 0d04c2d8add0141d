"""Options that several benches share."""

from __future__ import annotations

import click

from facecrf_ocio.settings import PRIORS

estimators_option = click.option(
    "--estimators",
    default="all",
    show_default=True,
    metavar="NAMES",
    help="all, or a list with commas.",
)
prior_option = click.option(
    "--prior",
    type=click.Choice(PRIORS),
    default="auto",
    show_default=True,
    help="What joint is told of the responses' family.",
)
