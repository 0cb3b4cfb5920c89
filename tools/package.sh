#!/usr/bin/env bash
# Builds what users install, and tries it as they would: `make package`. No container daemon is needed.
#
#   tools/package.sh wheel                  the tests of the wheel, by Python 3.11, 3.12 and 3.13, with packages of PyPI
#   tools/package.sh lowest                 the same by Python 3.11, with the lowest versions that pyproject.toml allows
#   tools/package.sh newest                 the same by Python 3.13, with the newest of what pyproject.toml bounds from above:
#                                           if it passes the bound can be raised, if not it keeps users from what fails
#   tools/package.sh base                   what runs without any extra, by Python 3.11, 3.12 and 3.13
#   tools/package.sh image [SUITE]          the steps of packaging/Dockerfile in a root of debootstrap, then two commands in it;
#                                           SUITE is another release of Debian than the one that the Dockerfile names
#
# An image is built from the last commit, as root. Everything is removed afterwards.
set -euo pipefail
cd "$(dirname "$0")/.."
ulimit -v 12000000 # kB of address space of one process

# Path of a Python, of PATH or of pyenv.
python_of() {
  local of_pyenv=("${PYENV_ROOT:-$HOME/.pyenv}"/versions/"$1".*/bin/python)
  command -v "python$1" || ls "${of_pyenv[-1]}" || { echo "package: there is no Python $1 here" >&2 && return 1; }
}

wheel() {
  local version python
  for version in 3.11 3.12 3.13; do
    python=$(python_of "$version")
    echo "package: wheel by $("$python" -V)"
    WHEEL_PYTHON=$python "${VENV:-.venv}/bin/python" -m pytest -q -p no:cacheprovider tests/installed/test_wheel.py
  done
}

lowest() {
  local python
  python=$(python_of 3.11)
  PIP_CONSTRAINT=$(mktemp) && export PIP_CONSTRAINT
  "$python" tools/lower_bounds.py >"$PIP_CONSTRAINT"
  echo "package: wheel by $("$python" -V), with $(tr '\n' ' ' <"$PIP_CONSTRAINT")"
  WHEEL_PYTHON=$python "${VENV:-.venv}/bin/python" -m pytest -q -p no:cacheprovider tests/installed/test_wheel.py
  rm "$PIP_CONSTRAINT"
}

newest() {
  local python
  python=$(python_of 3.13)
  WHEEL_UPGRADE=$("$python" tools/upper_bounds.py) && export WHEEL_UPGRADE
  echo "package: wheel by $("$python" -V), with the newest $WHEEL_UPGRADE, whatever pyproject.toml allows"
  WHEEL_PYTHON=$python "${VENV:-.venv}/bin/python" -m pytest -q -p no:cacheprovider tests/installed/test_wheel.py
}

base() {
  local version python
  for version in 3.11 3.12 3.13; do
    python=$(python_of "$version")
    echo "package: wheel without extras by $("$python" -V)"
    WHEEL_PYTHON=$python "${VENV:-.venv}/bin/python" -m pytest -q -p no:cacheprovider tests/installed/test_base_install.py
  done
}

# A command line in the root of the image, in the folder `at`, with the network settings of this machine for pip.
inside() {
  chroot "$@" /usr/bin/env -i HOME=/root PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin \
    PIP_CERT=/tmp/certificates PIP_NO_CACHE_DIR=1 "${settings[@]}" /bin/sh -ec "cd $at; $line"
}

image() {
  local suite=${1:-} at=/ settings=() word rest line mirror entry
  root=$(mktemp -d) && chmod 755 "$root"
  trap 'umount --quiet "$root"/proc; rm -rf --one-file-system "$root"' EXIT
  while read -r word rest; do
    echo "package: $word $rest"
    line=$rest
    case $word in
      FROM)
        suite=${suite:-${rest#debian:}}
        # this machine's own mirror
        mirror=$(apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' 'Component: main' | head -1)
        debootstrap --variant=minbase "$suite" "$root" "$mirror" >"$root.log" || { tail "$root.log"; return 1; }
        rm "$root.log"
        echo force-unsafe-io >"$root/etc/dpkg/dpkg.cfg.d/fast" # as in Debian's container images
        mount -t proc proc "$root/proc"
        install -d -m 1777 "$root/dev/shm"
        cp /etc/resolv.conf /etc/hosts "$root/etc"
        cp /etc/ssl/certs/ca-certificates.crt "$root/tmp/certificates"
        ;;
      COPY) [ "${rest% *}" = . ] && mkdir -p "$root/${rest#. }" && git archive HEAD | tar -x -C "$root/${rest#. }" ;;
      WORKDIR) at=$rest && mkdir -p "$root/$at" ;;
      ENV) settings+=("$rest") ;;
      RUN) inside "$root" ;;
      ENTRYPOINT) entry=$(tr -d '[]",' <<<"$rest") ;;
      *) echo "package: $word: unknown instruction" >&2 && return 1 ;;
    esac
  done < <(sed -e '/^ *#/d' -e '/^$/d' -e ':join; /\\$/ { N; s/\\\n//; b join }' packaging/Dockerfile)
  # as its user: own folder, no rights elsewhere
  cp examples/S-720-stops.toml "$root/$at"
  chown -R 1000:1000 "$root/$at"
  line="$entry impact S-720-stops.toml --out stops && ls -l stops/report.html"
  inside --userspec=1000:1000 "$root"
  line="$entry crossover yarn S-720 --out crossover && ls -l crossover/case.json"
  inside --userspec=1000:1000 "$root"
  du -sh --one-file-system "$root"
}

case ${1:-} in
  wheel) wheel ;;
  lowest) lowest ;;
  newest) newest ;;
  base) base ;;
  image) exec unshare --mount --fork "$0" image-in-own-mounts "${2:-}" ;;
  image-in-own-mounts) image "$2" ;;
  *) sed -n '2,13s/^# \{0,1\}//p' "$0" && exit 2 ;;
esac
