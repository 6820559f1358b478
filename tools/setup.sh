# Sourced by tools/run and tools/test: goes to the project's folder, installs the Debian packages that
# are missing, and builds with a preset.

cd "$(dirname "$0")/.." || exit 1

packages="build-essential cmake ninja-build libmujoco-dev libmujoco-samples libqhull-dev libeigen3-dev
  libassimp-dev libtinyxml2-dev libcli11-dev nlohmann-json3-dev libfmt-dev libpng-dev libegl-dev libopengl-dev libegl-mesa0
  libgl1-mesa-dri libglx-mesa0 libgtest-dev libgmock-dev libbenchmark-dev gnuplot-nox"

# install_packages NAME...: with apt-get, as root or through sudo, if any of them is not there.
install_packages() {
  missing=""
  for package in "$@"; do
    dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' ||
      missing="$missing $package"
  done
  [ -n "$missing" ] || return 0
  echo "Installing$missing" >&2
  sudo=""
  [ "$(id -u)" = 0 ] || sudo=sudo
  export DEBIAN_FRONTEND=noninteractive
  # shellcheck disable=SC2086
  { $sudo apt-get update -qq && $sudo apt-get install -y -qq --no-install-recommends $missing; } \
    >&2 </dev/null || { echo "$0: apt-get could not install$missing" >&2; exit 1; }
}

# build PRESET [TARGET...]: configure and build; the log is shown only if that fails.
build() {
  preset=$1
  shift
  log=$(mktemp)
  echo "Building ($preset)" >&2
  if ! { cmake --preset "$preset" -G Ninja && cmake --build --preset "$preset" ${1:+--target "$@"}; } \
    >"$log" 2>&1; then
    cat "$log" >&2
    rm -f "$log"
    exit 1
  fi
  rm -f "$log"
}
