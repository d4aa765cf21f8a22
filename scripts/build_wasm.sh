#!/usr/bin/env bash
# Builds build/wasm/apps/play/resilin_play.wasm, what `resilin export` puts into pages: the solver and the live scene, compiled
# to WebAssembly (preset wasm). Installs what is missing; the compiler goes into build/wasm-tools.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)
source "$root/scripts/setup.sh"

build_engine
du -h "$root/build/wasm/apps/play/resilin_play.wasm"
