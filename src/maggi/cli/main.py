"""The command `maggi` and how every one of its commands ends."""

from __future__ import annotations

import contextlib
import importlib
import os
import sys
import traceback
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any

import click

from maggi import __version__
from maggi.model.errors import ModelError, SimulationError

from .outcome import Outcome, failure
from .start import collector_off

COMMANDS: Mapping[str, str] = MappingProxyType(
    {name: f"maggi.cli.{name}" for name in ("run", "check", "plot", "export", "schema")}
)
NOT_BUILT = ("modes", "view")
CLOSED_PIPE = 128 + 13  # what a shell reports for a program ended by SIGPIPE
DEBUG_VARIABLE = "MAGGI_DEBUG"


class MaggiGroup(click.Group):
    """A group that imports a command when it is called, and turns every ending into a message and an exit status."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Names of the commands, in the order in which they are needed."""
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """A command by its name."""
        if cmd_name in NOT_BUILT:
            return _not_built(cmd_name)
        if cmd_name not in COMMANDS:
            return None
        command = getattr(importlib.import_module(COMMANDS[cmd_name]), cmd_name)
        assert isinstance(command, click.Command)
        return command

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command; a reader of the output who has had enough (``maggi schema | head``) ends it quietly."""
        try:
            return super().invoke(ctx)
        except BrokenPipeError:
            return _closed_pipe()

    def main(
        self,
        args: Sequence[str] | None = None,
        prog_name: str | None = None,
        complete_var: str | None = None,
        standalone_mode: bool = True,
        windows_expand_args: bool = True,
        **extra: Any,
    ) -> Any:
        """Run a command and end the process with its exit status."""
        arguments = sys.argv[1:] if args is None else list(args)
        try:
            with collector_off():
                ended = super().main(
                    arguments,
                    prog_name or "maggi",
                    complete_var,
                    standalone_mode=False,
                    windows_expand_args=windows_expand_args,
                    **extra,
                )
            sys.stdout.flush()
        except BrokenPipeError:
            ended = _closed_pipe()
        except Exception as error:
            outcome = _outcome(error, arguments)
            if "--json" in arguments:
                outcome.print_json()
            outcome.print_errors()
            sys.exit(outcome.exit_code)
        sys.exit(ended if isinstance(ended, int) else 0)


@click.group(
    cls=MaggiGroup,
    invoke_without_command=True,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
    epilog="A mistake in a model is reported as file:line:column. Exit status: 0 done, 1 the run failed (what was "
    "computed is kept), 2 a mistake in what was given, 130 interrupted.",
)
@click.version_option(__version__, "-V", "--version", message="maggi %(version)s")
@click.option("--traceback", is_flag=True, help=f"Show where an error in maggi itself arose (or set {DEBUG_VARIABLE}).")
@click.pass_context
def main(ctx: click.Context, traceback: bool) -> None:
    """Simulate mechanisms whose parts bend."""
    if ctx.invoked_subcommand is None:
        click.echo(ctx.get_help())


def _outcome(error: Exception, arguments: Sequence[str]) -> Outcome:
    """What an exception means to the user."""
    if isinstance(error, ModelError):
        return failure("error", error)
    if isinstance(error, click.Abort):
        return failure("interrupted", "interrupted")
    if isinstance(error, click.UsageError):
        command = error.ctx.command_path if error.ctx else "maggi"
        return failure("error", ModelError(error.format_message(), remedy=f"see `{command} --help`"))
    if isinstance(error, click.ClickException):
        return failure("error", error.format_message())
    if isinstance(error, SimulationError):
        return failure("failed", str(error))
    if isinstance(error, MemoryError):
        return failure(
            "failed", ModelError("there is not enough memory", remedy="use a coarser mesh, or fewer outputs")
        )
    return failure("failed", _bug(error, arguments))


def _closed_pipe() -> int:
    """Let nothing be written any more, not even when Python flushes at exit; the exit status."""
    with contextlib.suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return CLOSED_PIPE


def _bug(error: Exception, arguments: Sequence[str]) -> ModelError:
    if "--traceback" in arguments or os.environ.get(DEBUG_VARIABLE):
        traceback.print_exception(error)
        remedy = "please report it with the lines above"
    else:
        remedy = "`maggi --traceback …` shows where; please report it with what that prints"
    return ModelError(f"this is a bug in maggi: {type(error).__name__}: {error}", remedy=remedy)


def _not_built(name: str) -> click.Command:
    """A command of the contract that does not exist yet: it says so, whatever its arguments."""

    def refuse(rest: tuple[str, ...]) -> None:
        raise ModelError(f"`maggi {name}` is not built yet", remedy="`maggi --help` lists what there is")

    return click.Command(
        name,
        callback=refuse,
        params=[click.Argument(["rest"], nargs=-1, type=click.UNPROCESSED)],
        context_settings={"ignore_unknown_options": True},
        hidden=True,
        add_help_option=False,
    )
