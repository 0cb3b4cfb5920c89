"""What a woven fabric is: yarn, weave, compression law, response surface, catalogue, units and
errors."""

__version__ = "1.0.0"
