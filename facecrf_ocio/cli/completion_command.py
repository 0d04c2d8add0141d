"""`facecrf completion`: what a shell needs to complete our commands and options."""

from __future__ import annotations

import click

from facecrf_ocio.cli.terminal import DONE, ending_well


@click.command()
@click.argument("shell", type=click.Choice(("bash", "zsh", "fish")))
@click.pass_context
@ending_well
def completion(context: click.Context, shell: str) -> int:
    """Print a script by which SHELL completes commands, options and files.

    \b
    bash:  facecrf completion bash >> ~/.bashrc
    zsh:   facecrf completion zsh >> ~/.zshrc
    fish:  facecrf completion fish > ~/.config/fish/completions/facecrf.fish
    """  # noqa: D301 - \b is Click's mark of lines to be kept
    from click.shell_completion import get_completion_class

    kind = get_completion_class(shell)
    assert kind is not None  # noqa: S101 - Click has all three
    script = kind(context.find_root().command, {}, "facecrf", "_FACECRF_COMPLETE")
    # Not `source()`, which first asks for the version of a bash that need not be here.
    click.echo(script.source_template % script.source_vars())
    return DONE
