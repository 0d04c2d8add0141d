"""`facecrf explain`: what the words of results mean."""

from __future__ import annotations

import click

from facecrf_ocio.cli.terminal import columns

TOPIC_NAMES = ("verdicts", "outcomes", "exposure", "estimators")


@click.command()
@click.argument("topic", type=click.Choice(TOPIC_NAMES), default=TOPIC_NAMES[0])
def explain(topic: str) -> None:
    """Explain the words that results use: verdicts (the default), outcomes and more."""
    from facecrf_ocio.wording.explanations import WIDTH, explanation

    click.echo(explanation(topic, min(columns(), WIDTH)), nl=False)
