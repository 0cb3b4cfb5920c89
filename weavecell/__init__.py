"""The front door: commands, scene files, the walk of the data from fabric to impact, pictures and reports."""

__version__ = "0.1.0"
