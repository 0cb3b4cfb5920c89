"""The front door: commands, scene files, the walk of the data from fabric to impact, pictures and reports."""

from fabrics import __version__

__all__ = ["__version__"]
