"""The ledger: every testable claim of the thesis, with a check that computes our number beside it.

claims.toml says what is claimed and what would bear it out; `checks` compute our numbers, from `runs` that are made
once and shared; `judge` compares; `runner` does all of it, side by side, and keeps what is done. `python -m validation
claims` runs the ledger and writes the page.
"""
