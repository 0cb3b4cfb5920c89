"""The ledger: every testable claim of the thesis, with what it rests on, in one place.

claims.toml says what is claimed, which runs it needs, and what of them would bear it out, as expressions (`claims`,
`readers`) that call functions of `checks` for closed forms, quadratures and geometry. `runs` computes,
`judge` compares, `runner` does all of it side by side. `python -m validation claims` runs the ledger and writes its
table; a test holds each claim to its recorded verdict.
"""
