"""The commands that need `validation`: cost-accuracy charts, stability maps, claims ledger."""
