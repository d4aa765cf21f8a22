#!/usr/bin/env bash
# Makes what a release consists of, in dist/release or FOLDER: a wheel for each CPython, the sources, the site, SHA256SUMS.
#   scripts/release.sh [--out FOLDER] [--no-suite] [--no-site] [--no-play]
# Every wheel is installed in an empty environment and tried before it counts; of the interpreters that pyproject.toml
# names, those that this machine lacks are named. Installs what is missing; half an hour at 2 GHz where ccache has nothing.
#   --no-suite  the Python tests are not run on the wheels for the oldest and the newest Python
#   --no-site   no archive of the site, which is left out as well where scripts/build_site.sh has not fetched its tools
#   --no-play   the WebAssembly module, with which a wheel can `resilin export`, is taken as it is, or left out
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)
source "$root/scripts/setup.sh"

install_packages "${build_packages[@]}" "${python_packages[@]}"
install_python_environment
if [[ " $* " = *' --no-play '* ]]; then export RESILIN_ENGINE=as_it_is; else "$root/scripts/build_wasm.sh"; fi
export RESILIN_COMPILER_LAUNCHER=${RESILIN_COMPILER_LAUNCHER-ccache}
exec python3 "$root/scripts/release.py" "$@"
