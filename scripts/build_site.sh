#!/usr/bin/env bash
# Builds the documentation as a site, out/site/index.html, which opens from disk and from any server: pages, reference, gallery.
#   scripts/build_site.sh [--out DIR] [--no-pictures]
# Installs what is missing; pictures take some minutes, once. Scenes to play with are in it after scripts/build_wasm.sh.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)
source "$root/scripts/setup.sh"

install_packages "${build_packages[@]}" python3 python3-venv ffmpeg
install_site_tools || die "What makes the site could not be fetched; see $root/build/site/install.log"
"$root/run" info >/dev/null  # builds the program
exec "$root/build/site/venv/bin/python" "$root/scripts/website/build.py" "$@"
