# Functions that ./run and ./test share: install what is missing, configure when needed, build quietly.
# Sourced by bash with `root` set to the repository.

build_packages=(g++ cmake ninja-build libeigen3-dev libsuitesparse-dev libopenblas-dev libmetis-dev libtbb-dev
  libcli11-dev libtomlplusplus-dev nlohmann-json3-dev libspdlog-dev libfmt-dev libfreetype-dev libpng-dev zlib1g-dev libboost-dev
  ccache)  # what ./run compiles, ./test and the wheel need not compile again
test_packages=(libgtest-dev libgmock-dev python3 python3-venv ffmpeg fish zsh mandoc)
browser_packages=(nodejs npm chromium)
# Tests in Firefox, which has WebGL on screens alone; 87 MB more to fetch, so that elsewhere they run where both are there already.
[ "${CI-}" != true ] || browser_packages+=(firefox-esr xvfb)
wasm_packages=(cmake ninja-build libeigen3-dev nlohmann-json3-dev python3 python3-venv)  # of scripts/build_wasm.sh
petsc_packages=(libpetsc-real-dev openmpi-bin pkg-config)  # of the preset petsc alone
python_packages=(python3-dev python3-venv python3-numpy python3-scipy python3-matplotlib python3-torch
  libxrender1)  # which pyvista loads, without a display, too

say() { printf '%s\n' "$*" >&2; }
die() { say "$*"; exit 1; }

# A tool on PATH serves as well as Debian's package of it: prints the package names that a tool stands in for.
packages_replaced_by_tools() {
  command -v g++ >/dev/null && echo g++
  command -v ninja >/dev/null && echo ninja-build
  command -v ccache >/dev/null && echo ccache
  command -v node >/dev/null && echo nodejs
  command -v npm >/dev/null && echo npm
  command -v chromium >/dev/null && echo chromium
  local version
  version=$(cmake --version 2>/dev/null | sed -n '1s/[^0-9]*\([0-9.]*\).*/\1/p') || version=  # there is none
  [ -n "$version" ] && [ "$(printf '%s\n' 3.25 "$version" | sort -V | head -n 1)" = 3.25 ] && echo cmake
  return 0
}

# Prints the packages of "$@" that are absent.
missing_packages() {
  { packages_replaced_by_tools
    { dpkg-query -W -f='${db:Status-Status} ${Package}\n' "$@" 2>/dev/null || true; } | sed -n 's/^installed //p'
    echo '--'
    printf '%s\n' "$@"; } | awk '/^--$/ { wanted = 1; next } !wanted { have[$0] = 1; next } !($0 in have)'
}

# Installs the packages of "$@" that are absent; nothing is ever removed.
install_packages() {
  if ! command -v dpkg-query >/dev/null; then
    say "This is not a Debian system: the equivalents of these packages must be there already: $*"
    return 0
  fi
  local list missing=()
  list=$(missing_packages "$@") || die "Which of these packages are there could not be found out: $*"
  [ -n "$list" ] || return 0
  mapfile -t missing <<<"$list"

  local options=(-y --no-install-recommends --no-remove) as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    if command -v sudo >/dev/null && { [ -t 0 ] || sudo -n true 2>/dev/null; }; then
      as_root=(sudo)
    else
      say "These packages are missing and this user cannot install them. Run as root, then start again:"
      die "  apt-get update && apt-get install ${options[*]} ${missing[*]}"
    fi
  fi
  local apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -o DPkg::Lock::Timeout=120)
  local log
  log=$(mktemp)
  say "Installing ${missing[*]} ..."
  if ! "${apt[@]}" install "${options[@]}" "${missing[@]}" </dev/null >"$log" 2>&1; then
    # The package lists are absent or old.
    if ! { "${apt[@]}" update && "${apt[@]}" install "${options[@]}" "${missing[@]}"; } </dev/null >"$log" 2>&1; then
      tail -n 20 "$log" >&2
      rm -f "$log"
      die "The packages could not be installed: apt-get install ${options[*]} ${missing[*]}"
    fi
  fi
  rm -f "$log"
}

# cached_value PRESET NAME: a value of that build folder's CMake cache.
cached_value() { sed -n "s/^$2:[A-Z]*=//p" "$root/build/$1/CMakeCache.txt" 2>/dev/null; }

# Runs a command with its output in a log; shows the end of the log and fails when the command fails.
quietly() {
  local log=$1
  shift
  "$@" >"$log" 2>&1 || { tail -n 40 "$log" >&2; say "The whole log: $log"; return 1; }
}

# configure PRESET [-DNAME=VALUE ...]: when the folder is new, moved, older than the presets or set otherwise.
configure() {
  local preset=$1 folder=$root/build/$1 options=() option current=1
  shift
  [ -f "$folder/build.ninja" ] && [ "$folder/build.ninja" -nt "$root/CMakePresets.json" ] || current=0
  if [ -f "$folder/CMakeCache.txt" ] && [ "$(cached_value "$preset" CMAKE_HOME_DIRECTORY)" != "$root" ]; then
    options=(--fresh)
    current=0
  fi
  for option in "$@"; do
    local name=${option#-D}
    [ "$(cached_value "$preset" "${name%%=*}")" = "${name#*=}" ] || current=0
  done
  [ "$current" -eq 1 ] && return 0
  mkdir -p "$folder"
  command -v ccache >/dev/null && export RESILIN_COMPILER_LAUNCHER=${RESILIN_COMPILER_LAUNCHER-ccache}
  say "Configuring ($preset) ..."
  (cd "$root" && quietly "$folder/configure.log" cmake --preset "$preset" "${options[@]}" "$@")
}

# A step of a build takes this long [s], the mean over an optimised build on one core of 2 GHz.
seconds_per_step=4

# announce_build PRESET [TARGET ...]: one line about what is to do and how long it may take; fails when nothing is.
announce_build() {
  local preset=$1 last steps cores minutes
  shift
  last=$(ninja -C "$root/build/$preset" -n "$@" 2>/dev/null | tail -n 1) || true
  [[ $last != *'no work to do'* ]] || return 1
  steps=$(sed -n 's|^\[[0-9]*/\([0-9]*\)\].*|\1|p' <<<"$last")
  cores=$(nproc)
  minutes=$((${steps:-0} * seconds_per_step / cores / 60))
  if [ "$minutes" -ge 1 ]; then
    say "Building ($preset): $steps steps on $cores cores; about $minutes min at 2 GHz, less for what ccache has ..."
  else
    say "Building ($preset): ${steps:-some} steps ..."
  fi
}

# build PRESET [TARGET ...]: on all cores; progress on a terminal, otherwise one line unless it fails.
build() {
  local preset=$1 folder=$root/build/$1
  shift
  announce_build "$preset" "$@" || return 0
  if [ -t 2 ]; then
    NINJA_STATUS="Building ($preset) [%f/%t] " ninja -C "$folder" "$@" >&2
  else
    quietly "$folder/build.log" ninja -C "$folder" "$@"
  fi
}

# timed NAME COMMAND ...: says how long the command took and keeps it in `spent` for the table of ./test.
spent=()
timed() {
  local name=$1 start=$SECONDS status=0
  shift
  "$@" || status=$?
  local seconds=$((SECONDS - start))
  if [ "$seconds" -gt 0 ]; then
    say "    $name: $seconds s"
    spent+=("--spent=$name=$seconds")
  fi
  return "$status"
}

# The interpreter that Debian's Python packages belong to; another one on PATH would not see them.
python_interpreter() { [ -x /usr/bin/python3 ] && echo /usr/bin/python3 || command -v python3; }

# An environment with what builds and tests the Python package, in the versions of python/requirements-dev.txt, on top of
# the packages of the system.
install_python_environment() {
  local folder=$root/build/python/venv wanted=$root/python/requirements-dev.txt
  cmp -s "$wanted" "$folder/installed" && return 0
  say "Fetching what builds and tests the Python package ..."
  mkdir -p "$root/build/python"
  quietly "$root/build/python/install.log" "$(python_interpreter)" -m venv --system-site-packages "$folder" || return 1
  quietly "$root/build/python/install.log" "$folder/bin/pip" install --disable-pip-version-check \
    -r "$wanted" numpy scipy matplotlib || return 1
  cp "$wanted" "$folder/installed"
}

# What builds a wheel, a line each.
wheel_tools() { sed -n '/^# To build/,/^# To test/{/==/p}' "$root/python/requirements-dev.txt"; }

# install_wheel_tools PYTHON FOLDER: what builds a wheel for this interpreter, in an environment of its own.
install_wheel_tools() {
  local python=$1 folder=$2 wanted
  wanted="$("$python" -VV) $(wheel_tools)"
  [ "$(cat "$folder/installed" 2>/dev/null)" != "$wanted" ] || return 0
  say "Fetching what builds a wheel for $("$python" -V) ..."
  mkdir -p "$folder"
  # shellcheck disable=SC2046  # one word for each tool
  { "$python" -m venv --clear "$folder" && "$folder/bin/pip" install --disable-pip-version-check $(wheel_tools); } \
    >"$folder.log" 2>&1 || { tail -n 20 "$folder.log" >&2; return 1; }
  echo "$wanted" >"$folder/installed"
}

# What makes the site, in the versions of scripts/website/requirements.txt.
install_site_tools() {
  local folder=$root/build/site wanted=$root/scripts/website/requirements.txt
  cmp -s "$wanted" "$folder/installed" && return 0
  say "Fetching what makes the site ..."
  mkdir -p "$folder"
  { python3 -m venv "$folder/venv" && "$folder/venv/bin/pip" install --quiet --disable-pip-version-check -r "$wanted"; } \
    >"$folder/install.log" 2>&1 || return 1
  cp "$wanted" "$folder/installed"
}

# Fetches the compiler of WebAssembly in the version of cmake/wasm/requirements.txt, and says where it is (RESILIN_ZIG).
install_wasm_compiler() {
  local folder=$root/build/wasm-tools wanted=$root/cmake/wasm/requirements.txt
  if ! cmp -s "$wanted" "$folder/installed"; then
    say "Fetching $(cat "$wanted") ..."
    mkdir -p "$folder"
    { python3 -m venv "$folder/venv" && "$folder/venv/bin/pip" install --quiet --disable-pip-version-check -r "$wanted"; } \
      >"$folder/install.log" 2>&1 || return 1
    cp "$wanted" "$folder/installed"
  fi
  RESILIN_ZIG=$("$folder/venv/bin/python" -c 'import pathlib, ziglang; print(pathlib.Path(ziglang.__file__).parent / "zig")')
  export RESILIN_ZIG
}

# Builds what `resilin export` puts into pages: the solver and the live scene, in WebAssembly (preset wasm).
build_engine() {
  install_packages "${wasm_packages[@]}"
  install_wasm_compiler || die "The compiler of WebAssembly could not be fetched; see $root/build/wasm-tools/install.log"
  configure wasm
  build wasm resilin_play
}

# Fetches what builds and tests the page, in the versions of its lock file. Where that fails, what needs them is counted as
# skipped.
install_page_tools() {
  local folder=$root/apps/viewer/web
  cmp -s "$folder/package-lock.json" "$folder/node_modules/installed" && return 0
  say "Fetching what builds and tests the page ..."
  mkdir -p "$root/build/browser"
  (cd "$folder" && quietly "$root/build/browser/install.log" npm ci --no-audit --no-fund) || return 0
  cp "$folder/package-lock.json" "$folder/node_modules/installed"
}

# Puts the formatter and the linters on PATH, in the versions that .pre-commit-config.yaml names. Where they cannot
# be fetched, the checks that need them are counted as skipped.
install_tools() {
  local folder=$root/build/tools/venv wanted
  wanted=$(sed -n 's/^ *additional_dependencies: \[\(.*\)\]/\1/p' "$root/.pre-commit-config.yaml")
  if [ "$(cat "$folder/installed" 2>/dev/null)" != "$wanted" ]; then
    say "Fetching $(echo "$wanted" | paste -s -d ' ') ..."
    mkdir -p "$root/build/tools"
    # shellcheck disable=SC2086  # one word for each tool
    { python3 -m venv "$folder" && "$folder/bin/pip" install --quiet --disable-pip-version-check $wanted; } \
      >"$root/build/tools/install.log" 2>&1 || { say "That failed, see $root/build/tools/install.log"; return 0; }
    echo "$wanted" >"$folder/installed"
  fi
  export PATH="$folder/bin:$PATH"
}
