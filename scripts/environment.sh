# Sourced by the scripts of this folder (bash). Says where things are and gives a plain environment, so that neither a
# python3 of pyenv or conda nor another ROS workspace of the caller gets into the build.
package_dir=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build_dir=$package_dir/build
# Not below build/: rosrun looks past everything in a package's folder of that name.
devel_dir=$package_dir/devel
export PATH=/usr/sbin:/usr/bin:/sbin:/bin
unset PYTHONHOME PYTHONPATH CMAKE_PREFIX_PATH

# Installs the packages listed in the files named; prints on stderr only.
install_packages()
{
  "$package_dir/scripts/install_dependencies" "$@" >&2
}

# What the programs of the package are built from, the lists and state of Debian's packages among it.
built_from=(include src msg srv CMakeLists.txt package.xml scripts/environment.sh scripts/packages.txt)

# Whether all programs have been built, here, after the last change of what they are built from.
is_built()
{
  [ -f "$build_dir/.built" ] && [ "$(<"$build_dir/.built")" = "$package_dir" ] &&
    [ -z "$(cd "$package_dir" && find "${built_from[@]}" /var/lib/dpkg/status -newer "$build_dir/.built" -print -quit)" ]
}

# Configures (when needed) and builds: build_package [cmake options ...] [-- make targets ...]; prints on stderr only.
build_package()
{
  local options=() targets=()
  while [ $# -gt 0 ] && [ "$1" != -- ]; do options+=("$1"); shift; done
  shift || true
  targets=("$@")
  local stamp=$build_dir/.configured lock
  # One build at a time, however many scripts are started together.
  mkdir -p "$package_dir/.cache"
  exec {lock}>"$package_dir/.cache/build.lock"
  flock "$lock"
  if [ ! -f "$build_dir/Makefile" ] || [ ! -f "$stamp" ] || [ ${#options[@]} -gt 0 ]; then
    # A build folder that came along from another path cannot be reused: CMake refuses it.
    if [ -f "$build_dir/CMakeCache.txt" ] && ! grep -qx "CMAKE_HOME_DIRECTORY:INTERNAL=$package_dir" "$build_dir/CMakeCache.txt"; then
      rm -rf "$build_dir" "$devel_dir"
    fi
    cmake -S "$package_dir" -B "$build_dir" -DCMAKE_BUILD_TYPE=Release -DCATKIN_DEVEL_PREFIX="$devel_dir" \
      -DWARNINGS_AS_ERRORS=ON -DCATKIN_ENABLE_TESTING=OFF "${options[@]}" >&2 || return
    touch "$stamp"
  fi
  # As of now: what changes during the build is newer.
  local code=0 begin=$build_dir/.build_begin
  echo "$package_dir" >"$begin"
  cmake --build "$build_dir" --parallel "$(nproc)" ${targets[@]:+--target "${targets[@]}"} >&2 || code=$?
  if [ $code -eq 0 ] && { [ ${#targets[@]} -eq 0 ] || [ "${targets[0]}" = all ]; }; then
    mv "$begin" "$build_dir/.built"
  fi
  exec {lock}>&-
  return $code
}

# build_package with what it says in a file; on a terminal a line on the error output says how far it is:
# build_quietly LOG [as build_package ...]
build_quietly()
{
  local log=$1 bar= code=0
  shift
  : >"$log"
  if [ -t 2 ]; then
    show_build "$log" &
    bar=$!
  fi
  build_package "$@" >"$log" 2>&1 || code=$?
  if [ -n "$bar" ]; then
    kill "$bar" && wait "$bar" 2>/dev/null || true
    printf '\r\033[K' >&2
  fi
  return $code
}

# The last percentage of make in a log, and the time left were the rest as fast; ends with the script.
show_build()
{
  local start=$SECONDS percent elapsed
  sleep 2
  while kill -0 $$ 2>/dev/null; do
    percent=$(grep -oE '^\[ *[0-9]+%\]' "$1" | tail -n 1 | tr -dc 0-9 || true)
    elapsed=$((SECONDS - start))
    if [ "${percent:-0}" -gt 0 ]; then
      printf '\r\033[Kbuilding: %s %%, about %s s left' "$percent" $((elapsed * (100 - percent) / percent)) >&2
    else
      printf '\r\033[Kbuilding: %s s' "$elapsed" >&2
    fi
    sleep 1
  done
}

# The package's own ROS environment; the caller's ROS_PACKAGE_PATH and ROS_MASTER_URI are kept.
use_devel_space()
{
  local caller_path=${ROS_PACKAGE_PATH:-} caller_master=${ROS_MASTER_URI:-}
  unset ROS_PACKAGE_PATH
  set +u
  # shellcheck disable=SC1091
  source "$devel_dir/setup.bash" >&2
  set -u
  export ROS_PACKAGE_PATH=$package_dir${caller_path:+:$caller_path}:/usr/share
  export ROS_MASTER_URI=${caller_master:-http://localhost:11311}
}
