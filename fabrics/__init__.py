"""What a woven fabric is: yarn, weave, compression law, response surface, catalogue, units and errors."""
