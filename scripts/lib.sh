# shellcheck shell=bash
# Shared by the other scripts: `. "$(dirname "$0")/lib.sh"`. With --help, prints the opening comment of the calling
# script and exits; otherwise changes to the root of the repository.

case ${1:-} in -h | --help) sed -n '2,/^[^#]/{/^# shellcheck/d;/^#/s/^# \{0,1\}//p}' "$0"; exit ;; esac

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root" || exit

# Prints a message to stderr, with a prefix that distinguishes it from compiler output.
say() { printf '== %s\n' "$*" >&2; }
die() {
  printf '%s: %s\n' "$(basename "$0")" "$*" >&2
  exit 1
}

wanted_packages() { sed -e 's/#.*//' -e 's/[[:space:]]//g' -e '/^$/d' "$@"; }

missing_packages() {
  local package
  for package in $(wanted_packages "$@"); do
    [ "$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null)" = installed ] ||
      printf '%s\n' "$package"
  done
}

# setup_packages [LIST...]: installs missing packages from scripts/packages.txt and the lists. Never prompts: without
# permission to install, it prints the command to run. Only apt runs as root.
setup_packages() {
  local lists=(scripts/packages.txt "$@")
  if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    say "apt not found; install the packages listed in ${lists[*]} yourself"
    return 0
  fi
  local missing as_root=()
  mapfile -t missing < <(missing_packages "${lists[@]}")
  if [ ${#missing[@]} -eq 0 ]; then
    say "all packages of ${lists[*]} are installed"
    return 0
  fi
  if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null || ! sudo -n true 2>/dev/null; then
      die "packages are missing, and sudo requires a password. Run as root:" \
        "apt-get update && apt-get install -y --no-install-recommends ${missing[*]}"
    fi
    as_root=(sudo -n)
  fi
  say "installing ${#missing[@]} Debian packages: ${missing[*]}"
  local apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive NEEDRESTART_MODE=a
    apt-get -q -y -o DPkg::Lock::Timeout=600 -o Dpkg::Use-Pty=0 -o Acquire::Retries=3)
  local log
  log=$(mktemp)
  if ! { "${apt[@]}" update && "${apt[@]}" install --no-install-recommends "${missing[@]}"; } \
    >"$log" 2>&1 </dev/null; then
    tail -n 30 "$log" >&2
    rm -f "$log"
    die "apt could not install the packages; see its last lines above"
  fi
  rm -f "$log"
}

# `sudo scripts/demo` installs as root, then continues as the calling user, who could not repeat a build
# that belongs to root.
continue_as_caller() {
  if [ "$(id -u)" -eq 0 ] && [ -n "${SUDO_USER:-}" ] && [ "$SUDO_USER" != root ]; then
    say "continuing as $SUDO_USER"
    exec setpriv --reuid "$SUDO_USER" --regid "$(id -g "$SUDO_USER")" --init-groups \
      env -u SUDO_USER HOME="$(getent passwd "$SUDO_USER" | cut -d: -f6)" \
      "$root/scripts/$(basename "$0")" "$@"
  fi
}

# build PRESET [TARGET...]: configures and builds on all cores. With PLANESCOPE_WERROR=ON in the environment,
# warnings are errors.
build() {
  local preset=$1
  shift
  # Let checkouts in different folders share ccache's object files.
  export CCACHE_BASEDIR=$root CCACHE_NOHASHDIR=1
  export CCACHE_SLOPPINESS=include_file_mtime,include_file_ctime
  local werror=${PLANESCOPE_WERROR:-OFF}
  # GCC's sanitizer instrumentation raises false "may be used uninitialized" warnings.
  case $preset in asan | asan-core | tsan) werror=OFF ;; esac
  say "building build/$preset with $(nproc) jobs"
  cmake --preset "$preset" -DPLANESCOPE_WERROR="$werror" --log-level=WARNING >&2
  cmake --build "build/$preset" -j "$(nproc)" ${1:+--target "$@"} >&2
}

# out_folder DEFAULT WORDS...: prints the argument of -o or --out among the words
out_folder() {
  local out=$1
  shift
  while [ $# -gt 0 ]; do
    case $1 in
      -o | --out) out=${2:-} ;;
      --out=*) out=${1#*=} ;;
    esac
    shift
  done
  printf '%s\n' "$out"
}
