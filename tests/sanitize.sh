# Sourced by tests/run: the same tests with tools that watch memory. They take long.

# what Open MPI does by itself
SUPPRESSIONS="$ROOT/tests/suppressions"

# AddressSanitizer writes what it finds into files, for tests expect many runs to fail anyway. The other one
# writes to stderr, whatever it is told, if both are there: see harness_passes and tests/support/running.py. A run goes on after
# undefined behaviour, so that one run finds all of it.
watch_reports() {
  FOUND="$ROOT/build/sanitize"
  rm -rf "$FOUND"
  mkdir -p "$FOUND"
  export UBSAN_OPTIONS="log_path=$FOUND/report:print_stacktrace=1"
  export ASAN_OPTIONS="log_path=$FOUND/report:detect_stack_use_after_return=1:strict_string_checks=1"
}

# Open MPI and LAMMPS' harness leave much behind, and so does a LAMMPS that ends with an error: see valgrind
ignore_leaks() {
  export ASAN_OPTIONS="$ASAN_OPTIONS:detect_leaks=0"
}

# what was found, a line each
show_reports() {
  find "$FOUND" -name 'report.*' -exec grep -hE 'ERROR: (Address|Leak)Sanitizer|runtime error: ' {} +
}

# make_faulty FILE FLAGS...: a program that must be found faulty
make_faulty() {
  local output="$1"
  shift
  g++ -x c++ - -o "$output" "$@" <<'EOF'
#include <cmath>
int main(int argc, char **)
{
  volatile double nothing = NAN;
  const int whole = (int) nothing;
  const int *words = new int[argc];
  return words[argc] == whole;
}
EOF
}

# the sanitizers do look: what no integer is and what is beyond an array are both reported
expect_reports() {
  # shellcheck disable=SC2086
  make_faulty "$FOUND/faulty" $SANITIZE_FLAGS
  if "$FOUND/faulty" 2>"$FOUND/report.stderr" || [ "$(show_reports | wc -l)" -ne 2 ]; then
    die "the sanitizers do not see the faults of a faulty program, see build/sanitize"
  fi
  rm "$FOUND"/*
}

build_unit_sanitize() {
  export CCACHE_DIR="$CACHE/ccache"
  cmake -S "$ROOT/tests/unit" -B "$ROOT/build/unit-sanitize" -G Ninja -D CMAKE_CXX_COMPILER_LAUNCHER=ccache \
    -D CMAKE_CXX_FLAGS="$SANITIZE_FLAGS" -D CMAKE_BUILD_TYPE=None
  ninja -C "$ROOT/build/unit-sanitize" -j "$(nproc)"
}

# unit tests, harness, and all of tests/lammps that runs LAMMPS, under AddressSanitizer and
# UndefinedBehaviorSanitizer; and broken input, in process
part_sanitize() {
  install_repository test
  need_tree -sanitize
  do_quietly "building the kernel tests with sanitizers" build_unit_sanitize
  watch_reports
  expect_reports
  local status=0 passed failed skipped ok bad found yaml folder="$ROOT/build/harness-sanitize"
  ctest --test-dir "$ROOT/build/unit-sanitize" -j "$(nproc)" --output-on-failure --no-tests=error --timeout 600 \
    --output-junit "$REPORT/sanitize-unit.xml" >"$REPORT/sanitize-unit.log" 2>&1 || status=1
  read -r passed failed skipped <<<"$(count_junit "$REPORT/sanitize-unit.xml")"

  ignore_leaks
  rm -rf "$folder"
  mkdir -p "$folder"
  cd "$folder"
  for yaml in "$ROOT"/tests/lammps/fix-timestep-*.yaml; do
    if TREE=tree-sanitize harness_passes "$yaml" "$(basename "$yaml" .yaml).log"; then
      passed=$((passed + 1))
    else
      failed=$((failed + 1))
      echo "   $(basename "$yaml") is not OK, see build/harness-sanitize"
    fi
  done

  # not what the plugin's LAMMPS alone can do or refuse, nor what reads sources or compares logs
  GEARQUAT_TREE=tree-sanitize GEARQUAT_FUZZ_INPUTS="${GEARQUAT_FUZZ_INPUTS:-5000}" run_pytest sanitize tests/lammps \
    --ignore tests/lammps/test_plugin.py \
    --ignore tests/lammps/test_lammps_standards.py --ignore tests/lammps/test_example_logs.py \
    --deselect tests/lammps/test_force_styles.py::test_a_run_style_with_forces_elsewhere_is_not_followed \
    --deselect tests/lammps/test_extended.py::test_the_wheel_refuses \
    --deselect tests/lammps/test_pressure_tilted.py::test_a_build_that_cannot_flip_says_so \
    --deselect tests/lammps/test_extended.py::test_particles_of_style_body_are_refused \
    --deselect tests/lammps/test_atom_styles.py::test_quaternions_of_spheres \
    --deselect tests/lammps/test_atom_styles.py::test_normals_of_dielectrics \
    --deselect tests/lammps/test_atom_styles.py::test_an_arm_of_a_body \
    --deselect tests/lammps/test_atom_styles.py::test_friction_of_smoothed_particles \
    --deselect tests/lammps/test_atom_styles.py::test_fluids_of_rheo_move_all_atoms \
    --deselect "tests/lammps/test_memory.py::test_a_run_in_pieces_is_the_same_run[bond bpm/spring]" \
    --deselect "tests/lammps/test_memory.py::test_a_run_in_pieces_is_the_same_run[bond bpm/rotational]" \
    --deselect tests/lammps/test_coming_and_going.py::test_a_plugin_without_the_header_says_so \
    --deselect tests/lammps/test_automatic_values.py::test_a_body_in_a_dpd_fluid \
    --deselect "tests/lammps/test_other_fixes.py::test_refused_before_step_0[set 100 0 group all vx v_half]" \
    --deselect tests/lammps/test_accuracy_words.py::test_jumping_forces_are_told -n 2 --dist loadfile "$@" || status=1
  read -r ok bad skipped <"$REPORT/sanitize.count"
  show_reports | sort | uniq -c | sort -rn | head -n 40
  found="$(show_reports | wc -l)"
  echo "$((passed + ok)) $((failed + bad + found)) $skipped" >"$REPORT/sanitize.count"
  return "$status"
}

# short runs of what the fix can do, in the LAMMPS of all tests
part_valgrind() {
  need_tree
  local tree="$ROOT/build/tree" folder="$ROOT/build/valgrind" passed=0 failed=0 name words
  rm -rf "$folder"
  mkdir -p "$folder"
  export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 RES_OPTIONS=attempts:0
  # vector instructions of Open MPI's own sums are none that valgrind knows
  export OMPI_MCA_op=^avx OMPI_MCA_btl_vader_single_copy_mechanism=none OMPI_MCA_plm_rsh_agent=false
  local bytes=(valgrind -q --num-callers=50 --error-exitcode=99 --gen-suppressions=all --suppressions="$SUPPRESSIONS/valgrind"
    --suppressions=/usr/share/openmpi/openmpi-valgrind.supp)
  local leaks=("${bytes[@]}" --leak-check=full --errors-for-leak-kinds=definite --show-leak-kinds=definite)
  local twice=(mpirun.openmpi --map-by :OVERSUBSCRIBE --bind-to none -n 2)

  make_faulty "$folder/faulty" -g
  if "${bytes[@]}" "$folder/faulty" 2>"$folder/faulty.out"; then
    die "valgrind does not see the fault of a faulty program"
  fi

  # check NAME FOLDER LINE COMMAND...: no error of memory, and the output has the line of a run that went to its end
  check() {
    local name="$1" where="$2" line="$3" output="$folder/$(tr -c "[:alnum:]\n" - <<<"$1").out" status=0
    shift 3
    (cd "$where" && "$@") >"$output" 2>&1 || status=$?
    if [ "$status" -ne 99 ] && grep -q "$line" "$output" && ! grep -q '^==[0-9]*== [A-Z0-9]' "$output"; then
      passed=$((passed + 1))
    else
      failed=$((failed + 1))
      echo "   $name: see build/valgrind/${output##*/}"
      grep -A 12 '^==[0-9]*== [A-Z0-9]' "$output" | head -n 30 || true
    fi
  }

  # Only memory counts: valgrind computes in double precision what the start computes in extended one, so the harness
  # refuses the last digits of estimated errors. The harness itself loses a LAMMPS, so leaks are looked for below.
  for name in first_bonds momentum_extended second_values; do
    check "harness $name" "$folder" '^global_data, restart, respa' "${bytes[@]}" "$tree/test_fix_timestep" \
      "$ROOT/tests/lammps/fix-timestep-gear_quat_$name.yaml" --gtest_filter=FixTimestep.plain -s
  done
  for words in "formulation first" "tolerance 1e-8" "formulation first isokinetic separate" \
    "values 12 corrector gear compensate yes force 1 off off off torque 2* off off on" \
    "formulation second start zero project no corrector gear c0 velocity report no"; do
    check "fields $words" "$ROOT/examples/fields" '^Total wall time' "${leaks[@]}" "$tree/lmp" -in in.fields -log none \
      -var steps 20 -var every 5 -var words "$words"
  done
  check "case1 by infile" "$ROOT/benchmarks/scenes" '^Total wall time' "${leaks[@]}" "$tree/lmp" -in in.case1 -log none \
    -var body unrotated -var steps 20 -var every 5 -var out none
  check "water on two ranks" "$ROOT/examples/water" '^Total wall time' "${twice[@]}" "${leaks[@]}" "$tree/lmp" \
    -in in.water -log none -var forces plain -var steps 3 -var every 1 -var out none
  # forces are looked at again, among them those of a fix that is new in this run
  cat >"$folder/in.between" <<'EOF'
units lj
atom_style molecular
atom_modify map array
region box block -5 5 -5 5 -5 5
create_box 1 box
create_atoms 1 single 0 0 0
create_atoms 1 single 1 0 0
create_atoms 1 single 0 1.2 0.1
mass 1 1.0
set group all mol 1
velocity all create 1.0 4711 loop geom
pair_style zero 2.0
pair_coeff * *
fix move all gear/quat molecule
variable f equal 0.01*step
timestep 0.01
run 3
timestep 0.002
fix pull all addforce v_f 0.0 0.0
run 3
EOF
  check "forces between runs" "$folder" '^Total wall time' "${leaks[@]}" "$tree/lmp" -in in.between -log none
  # a body that reaches over both ranks beside a small one, scaled velocities, and a restart
  cat >"$folder/in.large" <<'EOF'
units lj
atom_style molecular
atom_modify map array
region box block -20 20 -5 5 -5 5
create_box 1 box
create_atoms 1 single -12 0 0
create_atoms 1 single 12 0.5 0
create_atoms 1 single 0 -1 0.3
create_atoms 1 single 0 1.2 0.1
create_atoms 1 single 1 1.2 0.9
mass 1 1.0
set atom 1*3 mol 1
set atom 4*5 mol 2
velocity all create 1.0 4711 loop geom
pair_style lj/cut 2.5
pair_coeff * * 1.0 1.0
fix move all gear/quat molecule
fix heat all langevin 1.0 1.0 1.0 4711
timestep 0.002
run 10
write_restart restart.large
clear
read_restart restart.large
pair_style lj/cut 2.5
pair_coeff * * 1.0 1.0
fix move all gear/quat molecule
fix heat all langevin 1.0 1.0 1.0 4711
run 10
EOF
  check "large body on two ranks" "$folder" '^Total wall time' "${twice[@]}" "${leaks[@]}" "$tree/lmp" -in in.large -log none
  echo "$passed $failed 0" >"$REPORT/valgrind.count"
  [ "$failed" -eq 0 ]
}
