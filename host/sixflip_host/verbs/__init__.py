"""One module a verb of the command: its arguments, what it runs, what it prints."""
