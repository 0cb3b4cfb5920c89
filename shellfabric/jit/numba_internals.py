"""Whether numba is of a version whose private interfaces `by_reference` and `inner_libraries` are known to fit.

With any other numba both do nothing: kernels give the same results and take twice as long to compile.
"""

import numba

TESTED = ((0, 68),)  # major and minor version
KNOWN = numba.version_info[:2] in TESTED
