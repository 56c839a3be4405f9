# Sourced by benchmarks/run, tests/run, doc/build, paper/build and cmake/packaging/check:
# installs system packages, .venv, and this repository in .venv.
# ROOT is the repository. This file only defines functions.

CACHE="$(realpath -m "${GEARQUAT_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/gearquat}")"

say() { printf '\n== %s\n' "$*"; }

die() {
  printf '\nerror: %s\n' "$*" >&2
  exit 1
}

# do_quietly WHAT COMMAND...: prints one line with WHAT and the duration; prints the output only if the command fails
do_quietly() {
  local what="$1" begin=$SECONDS log status=0
  shift
  mkdir -p "$ROOT/build/log"
  log="$ROOT/build/log/$(printf '%s' "$what" | tr -c 'A-Za-z0-9.\n' '-').log"
  printf '   %s ... ' "$what"
  # not `|| status=$?`, which would let the command continue after an error
  set +e
  (set -e; "$@") >"$log" 2>&1 </dev/null
  status=$?
  set -e
  if [ "$status" -ne 0 ]; then
    printf 'failed after %d s\n' $((SECONDS - begin))
    tail -n 40 "$log" >&2
    die "$what failed (exit code $status); all of its output is in ${log#"$ROOT"/}"
  fi
  printf '%d s\n' $((SECONDS - begin))
}

# answer_help ARGUMENT...: with --help among them, prints the comment at the head of the script, and exits
answer_help() {
  local word
  for word in "$@"; do
    case "$word" in -h | --help) sed -n '2,/^set /{/^#/s/^# \{0,1\}//p}' "$0"; exit ;; esac
  done
}

have() { command -v "$1" >/dev/null 2>&1; }

# --- system packages --------------------------------------------------------------------------

python_is_usable() {
  have python3 &&
    python3 -c 'import ensurepip, sys, venv; sys.exit(sys.version_info < (3, 10))' 2>/dev/null
}

# missing Debian packages that are required to install into .venv
missing_for_python() {
  python_is_usable || echo python3 python3-venv
  [ -e /etc/ssl/certs/ca-certificates.crt ] || echo ca-certificates
}

# the same, and packages to build the Python package
missing_for_package() {
  have g++ || echo g++
  missing_for_python
}

# the same, and packages for the tests
missing_for_tests() {
  missing_for_package
  have cmake || echo cmake
  have ninja || echo ninja-build
  have ccache || echo ccache
  have xz || echo xz-utils
  have git || echo git
  have valgrind || echo valgrind
  have mpicxx.openmpi || echo libopenmpi-dev
  have mpirun.openmpi || echo openmpi-bin
  [ -e /usr/include/yaml.h ] || echo libyaml-dev
  [ -e /usr/src/googletest/CMakeLists.txt ] || echo googletest
}

install_packages() {
  apt-get update && DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends "$@"
}

# need_packages FUNCTION: installs the packages that FUNCTION lists, or exits with the command to install them
need_packages() {
  local missing
  missing="$("$1" | xargs)"
  [ -z "$missing" ] && return
  if ! have apt-get; then
    die "this machine lacks what the Debian packages '$missing' contain; please install that"
  fi
  if [ "$(id -u)" -ne 0 ]; then
    die "system packages are missing. Please run this line, then try again:
  sudo apt-get update && sudo apt-get install -y --no-install-recommends $missing"
  fi
  # shellcheck disable=SC2086
  do_quietly "installing $missing" install_packages $missing
  missing="$("$1" | xargs)"
  [ -z "$missing" ] || die "still missing after installation: $missing"
}

# --- .venv ------------------------------------------------------------------------------------

# a checksum of all files of the installed package
fingerprint() {
  (
    cd "$ROOT"
    .venv/bin/python -V
    find CMakeLists.txt pyproject.toml cmake src -type f -not -path '*/__pycache__/*' -print0 |
      LC_ALL=C sort -z | xargs -0 sha256sum
  ) | sha256sum | cut -d' ' -f1
}

make_venv() {
  # scripts in a venv contain its path, so a copied or moved venv is created again
  if [ "$(cat "$ROOT/.venv/.place" 2>/dev/null)" != "$ROOT" ] ||
    ! "$ROOT/.venv/bin/python" -c 'import pip' 2>/dev/null; then
    rm -rf "$ROOT/.venv"
    do_quietly "making .venv with $(python3 -V)" python3 -m venv "$ROOT/.venv"
    echo "$ROOT" >"$ROOT/.venv/.place"
  fi
}

# listed FOLDER KEY...: the requirements under these keys of FOLDER/pyproject.toml
listed() {
  "$ROOT/.venv/bin/python" - "$ROOT/$1/pyproject.toml" "${@:2}" <<'EOF'
import sys
try:
    import tomllib
except ImportError:  # Python 3.10
    from pip._vendor import tomli as tomllib
with open(sys.argv[1], "rb") as file:
    found = tomllib.load(file)
for key in sys.argv[2:]:
    found = found[key]
print("\n".join(found))
EOF
}

# The build requirements are installed in .venv as well, so that a rebuild compiles only changed files.  Setuptools
# builds extensisq, which has no wheel.
pip_install_repository() {
  local extra="$1"
  cd "$ROOT"
  { listed . build-system requires; listed src/analysis build-system requires; } >build/requirements.txt
  printf '%s\n' cmake ninja 'setuptools>=70.1' >>build/requirements.txt
  .venv/bin/python -m pip install --disable-pip-version-check -r build/requirements.txt
  PATH="$ROOT/.venv/bin:$PATH" .venv/bin/python -m pip install --disable-pip-version-check \
    --no-build-isolation --config-settings=build-dir=build/plugin ./src/analysis ".$extra"
}

# install_repository EXTRA: installs this repository, with the optional dependencies of EXTRA, in .venv
install_repository() {
  local extra="$1" stamp="$ROOT/.venv/.installed" print
  mkdir -p "$ROOT/build"
  exec 9>"$ROOT/build/.lock"
  if have flock; then flock 9; fi
  make_venv
  # the tests also need the dependencies of the benchmarks
  [ "$(sed -n 2p "$stamp" 2>/dev/null || true)" = test ] && extra=test
  print="$(fingerprint)"
  if [ "$(cat "$stamp" 2>/dev/null)" != "$(printf '%s\n%s' "$print" "$extra")" ]; then
    rm -f "$stamp"
    do_quietly "installing lammps-gearquat[$extra] into .venv" pip_install_repository "[$extra]"
    printf '%s\n%s\n' "$print" "$extra" >"$stamp"
  fi
  exec 9>&-
}

# install_listed EXTRA: installs the requirements under EXTRA in pyproject.toml in .venv, without this repository
install_listed() {
  local extra="$1" stamp="$ROOT/.venv/.listed.$1" requirements
  mkdir -p "$ROOT/build"
  need_packages missing_for_python
  exec 9>"$ROOT/build/.lock"
  if have flock; then flock 9; fi
  make_venv
  requirements="$(listed . project optional-dependencies "$extra")"
  if [ "$(cat "$stamp" 2>/dev/null)" != "$requirements" ]; then
    printf '%s\n' "$requirements" >"$ROOT/build/$extra.txt"
    do_quietly "installing the tools for $extra into .venv" \
      "$ROOT/.venv/bin/python" -m pip install --disable-pip-version-check -r "$ROOT/build/$extra.txt"
    echo "$requirements" >"$stamp"
  fi
  exec 9>&-
}
