#!/usr/bin/env bash
# Brings a bare Debian 12 or 13 machine to the point where weavecell runs, and does nothing where nothing is missing.
#
# 1. Debian's Python and numpy, which the next two steps need.
# 2. Beside each other: the other packages of Debian (dolfinx, PETSc, gmsh, an HDF5 that shares their MPI); and a
#    virtual environment that sees them, with the rest from PyPI, and the kernels of a ply.
#
# EXTRAS=app,dev       what is installed from PyPI (pyproject.toml); what is there stays, what is not is added
# KERNELS=ply          compiled ahead: ply, all, none, or --portable (all, for other processors too)
# VENV=.venv, PYTHON=/usr/bin/python3
set -euo pipefail
cd "$(dirname "$0")/.."

python=${PYTHON:-/usr/bin/python3}
venv=${VENV:-.venv}
extras=${EXTRAS:-app}
kernels=${KERNELS:-ply}
# python3-dev has the version of Python: alone it would replace a Python that runs
first=(
  python3 python3-venv python3-dev python3-numpy python3-scipy ca-certificates
  libopenblas0-pthread                        # Debian's reference BLAS makes the factorisation 3 to 5 times slower
)
others=(
  gcc g++ libc6-dev                           # dolfinx compiles its forms at the first use
  python3-dolfinx python3-petsc4py python3-gmsh python3-meshio python3-h5py python3-h5py-mpi
  libgl1 libegl1 libxrender1 libx11-6         # off-screen pictures
  git make
)

if ! command -v dpkg-query >/dev/null; then
  echo "setup: this is not Debian; see environment.yml and CONTRIBUTING.md" >&2
  exit 1
fi
logs=$(mktemp -d)
run= # what `step` waits for
# what Debian installs is left to its end
trap '[ -z "$run" ] || kill "$run" 2>/dev/null; wait; rm -rf "$logs"' EXIT
SECONDS=0

as_root() { if [ "$(id -u)" = 0 ]; then "$@"; else sudo "$@"; fi; }

# Names of those of some packages that are not installed.
missing_of() {
  local installed package
  # dpkg-query fails where it does not know one of the names; what it prints is what counts
  installed=$(dpkg-query -W -f '${db:Status-Status} ${Package}\n' "$@" 2>/dev/null | sed -n 's/^installed //p' || true)
  for package in "$@"; do
    grep -qx "$package" <<<"$installed" || echo "$package"
  done
}

# Runs a command, and says every three seconds what it is at; if it fails, the end of what it printed.
# $1 : name of the part
step() {
  local name=$1 log began=$SECONDS
  shift
  log=$(mktemp -p "$logs")
  "$@" >"$log" 2>&1 </dev/null &
  run=$!
  (
    while sleep 3 && kill -0 "$run" 2>/dev/null; do
      at=$(grep -aE '^(Get:|Unpacking |Setting up |kernels: )' "$log" | tail -1 || true)
      echo "setup: $name, $((SECONDS - began)) s${at:+: ${at:0:70}}"
    done
  ) &
  local teller=$! status=0
  wait "$run" || status=$?
  run=
  kill "$teller" 2>/dev/null
  wait "$teller" 2>/dev/null || true
  if [ "$status" != 0 ]; then
    echo "setup: $name failed:" >&2
    tail -n 20 "$log" >&2
    return "$status"
  fi
  echo "setup: $name: $((SECONDS - began)) s"
}

# $1 : name of the part; $2 ... : packages of Debian
install_debian() {
  local name=$1
  shift
  step "$name" as_root env LC_ALL=C DEBIAN_FRONTEND=noninteractive \
    apt-get install --yes --no-install-recommends "$@"
}

# The environment, and in it all packages of PyPI of the extras in the file $1, one a line.
install_python() {
  local wheels version extra chosen=()
  [ -x "$venv/bin/python" ] || "$python" -m venv --without-pip --system-site-packages "$venv"
  if [ ! -x "$venv/bin/uv" ]; then
    wheels=(/usr/share/python-wheels/pip-*.whl)
    PYTHONPATH=${wheels[0]} "$python" -m pip --python "$venv/bin/python" install --quiet --disable-pip-version-check uv
  fi
  while read -r extra; do
    chosen+=(--extra "$extra")
  done <"$1"
  # certificates and index that pip takes too
  export UV_SYSTEM_CERTS=1 UV_DEFAULT_INDEX=${UV_DEFAULT_INDEX:-${PIP_INDEX_URL:-https://pypi.org/simple}}
  # petsc4py and dolfinx are compiled against Debian's numpy, and share an HDF5 with its h5py. uv does not see these:
  # they take part in the choice of versions, and are left out of what is installed; so is weavecell, which an extra names
  "$python" -c 'import numpy, scipy; print(f"numpy=={numpy.__version__}\nscipy=={scipy.__version__}")' >"$logs/system"
  "$venv/bin/uv" pip compile --quiet --python "$venv/bin/python" --constraint "$logs/system" "${chosen[@]}" \
    --no-header --no-annotate --output-file "$logs/chosen" pyproject.toml
  sed -i -E '/^(numpy|scipy|h5py|weavecell)\b/d' "$logs/chosen"
  # pip: for what users add themselves
  "$venv/bin/uv" pip install --python "$venv/bin/python" --no-deps --requirements "$logs/chosen" --editable . pip
}

# Lists Debian's h5py for pip, and refuses an environment with packages of its own in place of Debian's.
check_python() {
  # Debian lists it under other names: pip would bring another, with another HDF5 than that of dolfinx
  "$venv/bin/python" - <<'LISTED'
import sysconfig
from pathlib import Path

import h5py

listed = Path(sysconfig.get_path("purelib"), f"h5py-{h5py.__version__}.dist-info")
listed.mkdir(exist_ok=True)
(listed / "METADATA").write_text(f"Metadata-Version: 2.1\nName: h5py\nVersion: {h5py.__version__}\n")
(listed / "INSTALLER").write_text("tools/setup.sh\n")
LISTED
  "$venv/bin/python" - <<'CHECK'
import sys, numpy, scipy, h5py
for package in numpy, scipy, h5py:
    if package.__file__.startswith(sys.prefix):
        sys.exit(f"setup: {package.__name__} was replaced inside the environment; remove it and run again")
CHECK
}

compile() { OMP_NUM_THREADS=1 "$venv/bin/python" tools/compile_kernels.py "$@"; }

# $1 : of whom; the first run of a user compiles what is not compiled here
compile_ahead() {
  local name=$1
  shift
  step "kernels of $name" compile "$@" || echo "setup: the kernels were not compiled; the first run compiles them" >&2
}

stamp=$venv/.ready # what it was made by in the first line, then what it has, one a line
mapfile -t missing < <(missing_of "${first[@]}")
mapfile -t beside < <(missing_of "${others[@]}")
if [ ${#missing[@]} -gt 0 ] || [ ${#beside[@]} -gt 0 ]; then
  echo "setup: Debian packages, up to 430 MB, one to three minutes: ${missing[*]} ${beside[*]}"
  step "lists of Debian" as_root apt-get update -qq
fi
if [ ${#missing[@]} -gt 0 ]; then
  install_debian "Debian packages, Python" "${missing[@]}"
fi
debian=
if [ ${#beside[@]} -gt 0 ]; then
  install_debian "Debian packages, solvers" "${beside[@]}" &
  debian=$!
fi

made_by=$(cat pyproject.toml tools/setup.sh | sha256sum | cut -d' ' -f1)" $("$python" -V) $(dpkg-query -W -f '${Version}' python3-numpy)"
had=$(tail -n +2 "$stamp" 2>/dev/null || true)
made_today=
if [ "$(head -n 1 "$stamp" 2>/dev/null)" = "$made_by" ]; then
  made_today=1
else
  # of another version of numba, perhaps
  had=$(grep -v '^kernels:' <<<"$had" || true)
fi
wanted=$(printf '%s\n' ${extras//,/ } "kernels:$kernels" | grep -vx kernels:none)
# all kernels are those of a ply too
if grep -qx kernels:all <<<"$had"; then wanted=$(grep -vx kernels:ply <<<"$wanted" || true); fi
lacking=$(grep -vxFf <(printf '%s\n' "$had") <<<"$wanted" || true)
if [ -z "$made_today" ] || [ -n "$lacking" ]; then
  # what is there stays: packages of an extra that nobody asks for now are brought up to date too
  printf '%s\n' "$had" "$wanted" | grep -v '^kernels:' | grep . | sort -u >"$logs/extras"
  if [ -z "$made_today" ] || grep -qv '^kernels:' <<<"$lacking"; then
    echo "setup: Python packages ($(paste -sd, "$logs/extras")) into $venv, up to 1.3 GB on disk"
    step "Python packages" install_python "$logs/extras"
  fi
  case $kernels in
    ply | all) compile_ahead "a ply" ply ;;
  esac
fi
if [ -n "$debian" ]; then wait "$debian"; fi
if [ -z "$made_today" ] || [ -n "$lacking" ]; then
  check_python
  # woven solids need gmsh
  case $kernels in
    all) compile_ahead "all kinds of runs" all ;;
    --portable) compile_ahead "all kinds of runs" all --portable ;;
  esac
  printf '%s\n' "$made_by" "$had" "$wanted" | grep . | awk '!seen[$0]++' >"$stamp"
  echo "setup: all, $SECONDS s"
fi
