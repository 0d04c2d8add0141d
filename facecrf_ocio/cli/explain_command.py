"""`facecrf explain`: what the words of results mean."""

from __future__ import annotations

import click

TOPIC_NAMES = ("verdicts", "outcomes", "exposure", "estimators")


@click.command()
@click.argument("topic", type=click.Choice(TOPIC_NAMES), default=TOPIC_NAMES[0])
def explain(topic: str) -> None:
    """Explain the words that results use: verdicts (the default), outcomes and more."""
    from facecrf_ocio.wording.explanations import explanation

    click.echo(explanation(topic), nl=False)
