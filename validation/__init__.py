"""Published cases, verification of the methods, the ledger of claims, and models to compare with (`models`)."""
