"""The Python interface: what `import weavecell as wc` offers (`wc.fabric`, `wc.impact`, `wc.calibrate`, ...)."""
