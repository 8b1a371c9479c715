"""The commands of photon-splat."""

from __future__ import annotations

import argparse

from . import arguments, farm, info, merge
from .arguments import Parser


def parse(given: list[str] | None) -> argparse.Namespace:
    """Raises CommandError for options that make no sense."""
    options, more = parser().parse_known_args(given)
    if options.command == "farm":
        render = ["render", str(options.scene), "-o", "f_#.exr", *more]
        parser().parse_args(render)  # refuses what photon-splat render does not know
        options.more = more
    elif more:
        parser().error(f"unrecognized arguments: {' '.join(more)}")
    return options


def parser() -> argparse.ArgumentParser:
    top = Parser(prog="photon-splat", description="Renders Blender files with Photon Splat.")
    commands = top.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for one in (arguments, merge, info, farm):
        one.add_command(commands)
    return top
