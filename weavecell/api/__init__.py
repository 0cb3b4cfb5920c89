"""The Python interface: what `import weavecell as wc` offers (`wc.fabric`, `wc.shoot`, `wc.calibrate`, ...)."""
