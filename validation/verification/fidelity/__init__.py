"""The survey behind the error database of `weavecell.analysis.fidelity`."""
