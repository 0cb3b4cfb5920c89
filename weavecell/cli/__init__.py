"""The command line: arguments and help of every command."""
