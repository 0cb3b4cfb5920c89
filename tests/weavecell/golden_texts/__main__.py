"""Write the golden texts anew: `python -m tests.weavecell.golden_texts [NAME...]`. Read the difference before you keep
it."""

import sys

from tests.weavecell.golden_texts import cases

cases.write(sys.argv[1:] or list(cases.CASES))
