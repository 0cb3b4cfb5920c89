"""Where compiled numba kernels are kept: a folder named after the source of all kernels that may call each other.

numba stamps a cached function with the source of its own file alone, so that after a change in a kernel that is called
from another file the caller would go on running the old code, silently. Here the folder's name holds a digest of every
kernel file of the package and of what else it names that they are built on, and a change in any of them starts an
empty folder.
"""

from __future__ import annotations

import hashlib
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def kernel_cache(package_file, *others):
    """Import the kernels of the package whose `__init__.py` is `package_file` inside this block.

    others : files of the package that compiled code is in besides its *_kernels.py

    numba reads the folder when a function is decorated. A folder that the user has chosen (NUMBA_CACHE_DIR) is used as
    the root; otherwise the package's own __pycache__.
    """
    import numba

    folder = Path(package_file).parent
    sources = sorted([*folder.glob("*_kernels.py"), *(folder / name for name in others)])
    digest = hashlib.sha256(b"".join(path.read_bytes() for path in sources)).hexdigest()[:16]
    before = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = str(Path(before or folder / "__pycache__") / f"kernels-{digest}")
    try:
        yield
    finally:
        numba.config.CACHE_DIR = before
