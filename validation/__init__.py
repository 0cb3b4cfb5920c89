"""Studies of the methods and of published cases, the ledger of claims, and models to compare with (`models`)."""
