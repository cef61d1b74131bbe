"""sixflip completion: the verbs, options and files of a command line, for the shell to offer."""

import argparse

import shtab

EXAMPLE = ("sixflip completion bash > ~/.local/share/bash-completion/completions/sixflip\n"
           "         sixflip completion zsh > ~/.zfunc/_sixflip\n"
           "         sixflip completion fish > ~/.config/fish/completions/sixflip.fish")
SHELLS = ("bash", "zsh", "fish")


def add_arguments(parser):
    """The options of the verb."""
    parser.add_argument("shell", choices=SHELLS)


def run(args):
    """Print the script."""
    print(shtab.complete(whole_parser(), args.shell))
    return 0


def whole_parser():
    """One parser of all verbs, made of theirs."""
    from .cli import add_global, load
    from .verb_table import VERBS
    root = argparse.ArgumentParser(prog="sixflip")
    root.add_argument("--version", action="store_true", help="of sixflip")
    verbs = root.add_subparsers(dest="verb")
    for verb in VERBS:
        module = load(verb)
        parser = verbs.add_parser(verb, help=VERBS[verb][1])
        add_global(parser)
        module.add_arguments(parser)
        for action in parser._actions:      # argparse has no other way to ask
            if takes_file(action):
                action.complete = shtab.FILE
    return root


def takes_file(action):
    """Whether the value of an argument is the name of a file; a port is one, too."""
    return hasattr(action, "reads") or hasattr(action, "writes") or action.metavar == "PORT"
