"""The commands: arguments and options of each as its signature, its help as its docstring, and what it does."""
