# What samples/run and tests/run share: packages, configuration, build. Sourced in the root of the
# clone.

fail() {
  echo "${0##*/}: $*" >&2
  exit 1
}

# say SENTENCE: a heading between the stages
say() {
  printf '\n== %s\n' "$*"
}

# packages GROUP...: the names in these groups of packages.txt
packages() {
  sed 's/#.*//' packages.txt | awk -v groups=" $* " '
    NF && /^\[/ { on = index(groups, " " substr($1, 2, length($1) - 2) " "); next }
    NF && on { print $1 }'
}

# missing_packages GROUP...: those of them that are not installed
missing_packages() {
  local wanted
  wanted=$(packages "$@" | sort -u)
  comm -23 <(echo "$wanted") \
    <(dpkg-query -W -f '${db:Status-Status} ${Package}\n' $wanted 2>/dev/null |
      sed -n 's/^installed //p' | sort -u)
}

# apt_install PACKAGE...: never asks the user
apt_install() {
  local as_root=(env DEBIAN_FRONTEND=noninteractive)
  ((EUID == 0)) || as_root=(sudo -n "${as_root[@]}")
  echo "Installing $# packages and what they depend on (apt says how much that is): $*"
  "${as_root[@]}" apt-get update && "${as_root[@]}" apt-get install -y --no-install-recommends "$@"
}

# install_packages GROUP...: asks apt only when something is missing
install_packages() {
  local missing
  mapfile -t missing < <(missing_packages "$@")
  if ((${#missing[@]} == 0)); then
    echo "All are installed."
    return
  fi
  apt_install "${missing[@]}" ||
    fail "These Debian packages are missing and could not be installed from here;" \
      "install them and run this again: ${missing[*]}"
}

# install_cargo: any will do, and the build goes on without
install_cargo() {
  command -v cargo "${HOME:-}/.cargo/bin/cargo" >/dev/null && return
  apt_install $(packages fbx) || echo "There is no cargo: FBX files will be read through assimp," \
    "which loses steps, tangents and layers." >&2
}

# configure TESTS: ON or OFF; a build folder that has the tests already serves both.
# PAPERBAKE_WERROR=ON in the environment makes warnings errors; without it the folder stays as it
# is, and a new one has them as warnings.
configure() {
  local wanted=("PAPERBAKE_TESTS:BOOL=$1") options=(-DPAPERBAKE_TESTS="$1" -DPAPERBAKE_UNITY=ON)
  [[ $1 == ON ]] || wanted=()
  if [[ -n ${PAPERBAKE_WERROR:-} ]]; then
    wanted+=("PAPERBAKE_WERROR:BOOL=$PAPERBAKE_WERROR")
    options+=(-DPAPERBAKE_WERROR="$PAPERBAKE_WERROR")
  fi
  if [[ -f build/build.ninja ]] && has_settings "${wanted[@]}"; then
    echo "It is configured already."
    return
  fi
  install_cargo
  cmake -S . -B build -G Ninja "${options[@]}"
}

# has_settings LINE...: whether the build folder is configured so
has_settings() {
  local line
  for line; do
    grep -qxF "$line" build/CMakeCache.txt || return 1
  done
}

# steps_left TARGET: how many files the build has yet to compile or link
steps_left() {
  cmake --build build --target "$1" -- -n | grep -c '^\[[0-9]' || true
}

# build [TARGET]: everything when no target is named
build() {
  local target=${1:-all} steps cores
  steps=$(steps_left "$target") cores=$(nproc)
  if ((steps == 0)); then
    echo "It is compiled already."
    return
  fi
  # paperbake's 35 steps took 380 s of CPU time on a Xeon (Sapphire Rapids, 2.0 GHz) without ccache,
  # 11 s each
  local minutes=$(((steps * 11 / cores + 59) / 60))
  if [[ $target == paperbake ]] && ((minutes > 1)); then
    echo "$steps steps on $cores cores: about $minutes minutes, less where ccache knows them;" \
      "ninja counts them."
  fi
  cmake --build build --target "$target"
}
