"""Sphinx configuration: the pages of this folder, and the reference pages that are made from the code."""

import re
import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE.parent), str(HERE.parent / "tools")]

import gallery  # noqa: E402
import python_page  # noqa: E402

from fabrics import __version__  # noqa: E402

project, author, copyright = "weavecell", "The weavecell developers", "The weavecell developers"
version = release = __version__
extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.mathjax",
    "numpydoc",
    "sphinx_gallery.gen_gallery",
    "study_directives",
]
exclude_patterns = ["_build", "conf.py", "generated/examples", "generated/gallery/*.ipynb"]
highlight_language = "none"  # blocks without a language are commands and their output
smartquotes = False  # options such as --out keep their hyphens
html_theme = "furo"
html_title = f"weavecell {__version__}"
html_show_copyright = False
html_static_path = ["_static"]
html_css_files = ["wide.css"]

myst_heading_anchors = 4  # every key of generated/input.md has one
myst_enable_extensions = ["dollarmath", "colon_fence"]
autodoc_typehints = "none"  # shape and unit stand in the docstrings
autodoc_member_order = "bysource"
autodoc_mock_imports = ["dolfinx", "petsc4py", "mpi4py", "ufl", "basix", "gmsh", "meshio"]
numpydoc_show_class_members = False
numpydoc_show_inherited_class_members = False
numpydoc_xref_param_type = False
numpydoc_validation_checks = {
    "GL08",
    "SS01",
    "PR01",
    "PR02",
}  # a docstring, its summary, each parameter and no other
# methods say their parameters in words; a class with the parameters of its base documents its own
numpydoc_validation_exclude = {r"\.[A-Z]\w*\.\w+$", r"^meshing\.(Crossover|Patch)$"}
numpydoc_validation_exclude |= {r"^weavecell\.ShotResult$"}
# their docstrings have the keywords that they pass on as **options
numpydoc_validation_exclude |= {rf"^weavecell\.{name}$" for name in python_page.passing_on()}

nb_execution_mode = "off"  # the notebooks are kept with the outputs of `python tools/notebooks.py`

gallery.copy(HERE / "generated" / "examples")
sphinx_gallery_conf = gallery.settings("generated/examples", "generated/gallery")


def show_directives(app, docname, source):
    """Take directives out of the comments in which they stand, so that a forge does not show them as text."""
    source[0] = re.sub(
        r"^<!--\n(```\{.*?^```)\n-->$", r"\1", source[0], flags=re.MULTILINE | re.DOTALL
    )


def lead_to_copies(app, docname, source):
    """Links to pages outside docs lead to the site's copies of these."""
    import reference_pages

    if "validation/reports/" in source[0]:
        folder = (HERE / docname).parent
        source[0] = reference_pages.with_links(source[0], folder, folder)


def escape_stars(app, what, name, thing, options, lines):
    """A pattern such as *.csv in a docstring is no emphasis."""
    lines[:] = [re.sub(r"(?<!`)\*\.", r"\\*.", line) for line in lines]


def setup(app):
    """Write the pages that are made from the code before Sphinx reads its sources."""
    import reference_pages
    from pygments.lexers.special import TextLexer

    app.add_lexer("csv", TextLexer)  # of the pages' data, which Pygments does not know
    app.connect("source-read", show_directives)
    app.connect("source-read", lead_to_copies)
    app.connect("autodoc-process-docstring", escape_stars)
    app.connect("builder-inited", lambda _: reference_pages.write(HERE / "generated"))
