"""The command line: all commands as one program, its errors and exit codes."""
