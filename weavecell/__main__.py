"""`python -m weavecell` is the same as the `weavecell` command."""

from weavecell.cli.app import main

if __name__ == "__main__":
    main()
