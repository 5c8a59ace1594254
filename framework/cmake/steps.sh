# Shared by demo.sh and test.sh: quiet steps with progress, and the packages they need. Sourced, from the top folder.

logs=build/logs
mkdir -p "$logs"
jobs=${LOOM_JOBS:-$(nproc)}

# step LABEL COMMAND...: runs it quietly; its output is shown only where it fails.
step() {
  local label=$1 log began now code=0
  shift
  log=$logs/$(printf '%s' "$label" | tr -cs 'a-zA-Z0-9' '-').log
  began=$(date +%s)
  if [ -t 1 ]; then
    "$@" >"$log" 2>&1 </dev/null &
    local pid=$!
    while kill -0 "$pid" 2>/dev/null; do
      printf '\r\033[K%s … %s' "$label" "$(tail -c 300 "$log" | tr '\r' '\n' | tail -n 1 | cut -c 1-70)"
      sleep 0.5
    done
    wait "$pid" || code=$?
    printf '\r\033[K'
  else
    printf '%s … ' "$label"
    "$@" >"$log" 2>&1 </dev/null || code=$?
  fi
  now=$(date +%s)
  [ -t 1 ] && printf '%s … ' "$label"
  if [ "$code" -ne 0 ]; then
    printf 'failed (%d s)\n' $((now - began))
    tail -n "${LOOM_LOG_LINES:-60}" "$log"
    printf 'whole log: %s\n' "$log"
    return "$code"
  fi
  printf 'ok (%d s)\n' $((now - began))
}

# install_packages [test]: installs what framework/cmake/packages.txt names and the machine lacks.
install_packages() {
  command -v dpkg-query >/dev/null 2>&1 || {
    echo "This is no Debian-like system: install what framework/cmake/packages.txt names by other means."
    return 0
  }
  local wanted missing= name
  wanted=$(sed -e '/^#/d' -e '/^test /d' framework/cmake/packages.txt)
  [ "${1:-}" = test ] && wanted="$wanted $(sed -n 's/^test //p' framework/cmake/packages.txt)"
  for name in $wanted; do
    dpkg-query -W -f='${db:Status-Status}\n' "$name" 2>/dev/null | grep -qx installed || missing="$missing $name"
  done
  [ -z "$missing" ] && return 0
  local as_root=
  if [ "$(id -u)" -ne 0 ]; then
    if command -v sudo >/dev/null 2>&1 && sudo -n true 2>/dev/null; then
      as_root='sudo -n'
    else
      echo "These packages are missing, and installing them takes root:"
      echo "  apt-get install$missing"
      return 1
    fi
  fi
  step "list of packages" $as_root env DEBIAN_FRONTEND=noninteractive apt-get -q update || return 1
  # shellcheck disable=SC2086
  step "installing$missing" $as_root env DEBIAN_FRONTEND=noninteractive \
    apt-get -q -y install --no-install-recommends $missing
}

# configure FOLDER OPTION...: CMake with what is at hand; quick where it was done before.
configure() {
  local folder=$1
  shift
  set -- -S . -B "$folder" "$@"
  [ -e "$folder/CMakeCache.txt" ] || set -- -G Ninja "$@"
  # ccache need not preprocess what it has not got, since Ninja has the names of all headers; precompiled ones it takes
  # with these words.
  export CCACHE_DEPEND=1 CCACHE_SLOPPINESS=pch_defines,time_macros
  command -v ccache >/dev/null 2>&1 && set -- "$@" -DCMAKE_CXX_COMPILER_LAUNCHER=ccache
  cmake "$@"
}
