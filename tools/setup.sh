#!/usr/bin/env bash
# Brings a bare Debian 12 or 13 machine to the point where weavecell runs, and does nothing where nothing is missing.
#
# 1. System packages by apt: the solvers (dolfinx, PETSc), gmsh, meshio and an HDF5 that shares their MPI.
# 2. A virtual environment that sees them, with the rest from PyPI and numpy pinned to the system's version:
#    petsc4py and dolfinx are compiled against it, and an unpinned install would silently replace it.
set -euo pipefail
cd "$(dirname "$0")/.."

python=${PYTHON:-/usr/bin/python3}
venv=${VENV:-.venv}
extras=${EXTRAS:-app,dev} # KERNELS=--portable compiles for other processors too
packages=(
  python3 python3-venv python3-dev gcc g++ libc6-dev      # dolfinx compiles its forms at the first use
  python3-dolfinx python3-petsc4py python3-gmsh python3-meshio python3-h5py python3-h5py-mpi
  python3-numpy python3-scipy
  libopenblas0-pthread                        # Debian's reference BLAS makes the factorisation 3 to 5 times slower
  libgl1 libegl1 libxrender1 libx11-6         # off-screen pictures
  git make ca-certificates
)

as_root() { if [ "$(id -u)" = 0 ]; then "$@"; else sudo "$@"; fi; }

missing=()
if command -v dpkg-query >/dev/null; then
  # dpkg-query fails where it does not know one of the names; what it prints is what counts
  installed=$(dpkg-query -W -f '${db:Status-Status} ${Package}\n' "${packages[@]}" 2>/dev/null | sed -n 's/^installed //p' || true)
  for package in "${packages[@]}"; do
    grep -qx "$package" <<<"$installed" || missing+=("$package")
  done
else
  echo "setup: this is not Debian; see environment.yml and CONTRIBUTING.md" >&2
  exit 1
fi
# every so many packages, one line of what apt or pip is at
progress() {
  local n=0 line name
  while IFS= read -r line; do
    case $line in
      "Setting up "* | "Collecting "*)
        name=${line#Setting up }
        name=${name#Collecting }
        if [ $((n % $1)) = 0 ]; then echo "setup:   $((n + 1)), ${name%%[ <>=~!;[(]*}"; fi
        n=$((n + 1))
        ;;
      "Installing collected packages"*) echo "setup:   $(wc -w <<<"${line#*:}") packages to install" ;;
    esac
  done
}

if [ ${#missing[@]} -gt 0 ]; then
  echo "setup: installing Debian packages, a few minutes: ${missing[*]}"
  as_root apt-get update -qq
  install=(env LC_ALL=C DEBIAN_FRONTEND=noninteractive apt-get install --no-install-recommends "${missing[@]}")
  as_root "${install[@]}" --assume-no 2>&1 | sed -n 's/^\(Need to get\|After this operation\)/setup:   \1/p' || true
  as_root "${install[@]}" --yes | progress 25
fi

stamp=$venv/.ready
wanted=$(cat pyproject.toml tools/setup.sh | sha256sum | cut -d' ' -f1)" $extras $("$python" -V) $(dpkg-query -W -f '${Version}' python3-numpy)"
if [ ! -f "$stamp" ] || [ "$(cat "$stamp")" != "$wanted" ]; then
  echo "setup: preparing $venv, Python packages from PyPI: up to 1.3 GB on disk, 2 to 5 minutes"
  [ -x "$venv/bin/python" ] || "$python" -m venv --system-site-packages "$venv"
  # Debian lists its h5py under other names: pip would bring another, with another HDF5 than that of dolfinx
  "$venv/bin/python" - <<'LISTED'
import sysconfig
from pathlib import Path

import h5py

listed = Path(sysconfig.get_path("purelib"), f"h5py-{h5py.__version__}.dist-info")
listed.mkdir(exist_ok=True)
(listed / "METADATA").write_text(f"Metadata-Version: 2.1\nName: h5py\nVersion: {h5py.__version__}\n")
(listed / "INSTALLER").write_text("tools/setup.sh\n")
LISTED
  pin=$(mktemp)
  trap 'rm -f "$pin"' EXIT
  "$python" -c 'import numpy; print("numpy==" + numpy.__version__)' >"$pin"
  "$venv/bin/python" -m pip install --progress-bar off --disable-pip-version-check --constraint "$pin" --editable ".[$extras]" |
    progress 10
  "$venv/bin/python" - <<'CHECK'
import sys, h5py, numpy
for package in (numpy, h5py):
    if sys.prefix in package.__file__:
        sys.exit(f"setup: {package.__name__} was replaced inside the environment; remove it and run again")
CHECK
  # what the first shot of a user would wait for
  if [ "$extras" != app,docs ]; then
    echo "setup: compiling the kernels of all kinds of runs, once: two to three minutes"
    OMP_NUM_THREADS=1 "$venv/bin/python" tools/compile_kernels.py ${KERNELS:-} 2>/dev/null ||
      echo "setup: the kernels were not compiled; the first run compiles them" >&2
  fi
  echo "$wanted" >"$stamp"
fi
