# What samples/run and tests/run share: packages, configuration, build. Sourced in the root of the clone.

fail() {
  echo "${0##*/}: $*" >&2
  exit 1
}

# packages GROUP...: the names in these groups of packages.txt
packages() {
  sed 's/#.*//' packages.txt | awk -v groups=" $* " 'NF && /^\[/ { on = index(groups, " " substr($1, 2, length($1) - 2) " "); next } NF && on { print $1 }'
}

# missing_packages GROUP...: those of them that are not installed
missing_packages() {
  local wanted
  wanted=$(packages "$@" | sort -u)
  comm -23 <(echo "$wanted") <(dpkg-query -W -f '${db:Status-Status} ${Package}\n' $wanted 2>/dev/null | sed -n 's/^installed //p' | sort -u)
}

# apt_install PACKAGE...: never asks the user
apt_install() {
  local as_root=(env DEBIAN_FRONTEND=noninteractive)
  ((EUID == 0)) || as_root=(sudo -n "${as_root[@]}")
  echo "Installing $*"
  "${as_root[@]}" apt-get update && "${as_root[@]}" apt-get install -y --no-install-recommends "$@"
}

# install_packages GROUP...: asks apt only when something is missing
install_packages() {
  local missing
  mapfile -t missing < <(missing_packages "$@")
  ((${#missing[@]})) || return 0
  apt_install "${missing[@]}" || fail "These Debian packages are missing and could not be installed from here; install them and run this again: ${missing[*]}"
}

# install_cargo: any will do, and the build goes on without
install_cargo() {
  command -v cargo "${HOME:-}/.cargo/bin/cargo" >/dev/null && return
  apt_install $(packages fbx) || echo "There is no cargo: FBX files will be read through assimp, which loses steps, tangents and layers." >&2
}

# configure TESTS: ON or OFF; a build folder that has the tests already serves both
configure() {
  if [[ -f build/build.ninja ]]; then
    [[ $1 == OFF ]] || grep -q '^PAPERBAKE_TESTS:BOOL=ON$' build/CMakeCache.txt && return
  fi
  install_cargo
  cmake -S . -B build -G Ninja -DPAPERBAKE_TESTS="$1"
}

# build [TARGET]: everything when no target is named
build() {
  cmake --build build --target "${1:-all}"
}
