"""What a woven fabric is: yarn, weave, compression law, response surface, catalogue, units and
errors."""

__version__ = "0.2.0"
