# Builds GEARQUAT into a LAMMPS tree that is not edited:
#
#   cmake -S lammps/cmake -B build -D CMAKE_PROJECT_lammps_INCLUDE=gearquat/cmake/lammps-gearquat.cmake
#
# LAMMPS (4 Feb 2025 or later) reads this file at its `project(lammps)`, before anything else is
# known. What needs the target `lammps` is therefore put off to the end of LAMMPS' CMakeLists.txt.

if(CMAKE_VERSION VERSION_LESS 3.19)
  message(FATAL_ERROR "GEARQUAT: adding the package without editing LAMMPS needs CMake 3.19 or later, "
    "this is ${CMAKE_VERSION}. Copy src/GEARQUAT into LAMMPS' src and add it to STANDARD_PACKAGES instead.")
endif()

option(GEARQUAT_CHECKS "Compare the collective calls of all ranks, for tests" OFF)
option(GEARQUAT_PRECOMPILE_HEADERS "Build LAMMPS with precompiled headers (half the compile time)" OFF)

get_filename_component(GEARQUAT_FOLDER "${CMAKE_CURRENT_LIST_DIR}/../src/GEARQUAT" ABSOLUTE)
file(GLOB GEARQUAT_SOURCES CONFIGURE_DEPENDS "${GEARQUAT_FOLDER}/*.cpp")
file(GLOB GEARQUAT_STYLES CONFIGURE_DEPENDS "${GEARQUAT_FOLDER}/fix_*.h")
if(NOT GEARQUAT_SOURCES)
  message(FATAL_ERROR "GEARQUAT: no sources in ${GEARQUAT_FOLDER}")
endif()
if(EXISTS "${CMAKE_SOURCE_DIR}/../src/GEARQUAT")
  message(FATAL_ERROR "GEARQUAT: this LAMMPS tree has a copy of the package in src/GEARQUAT already. "
    "Remove it, or leave out CMAKE_PROJECT_lammps_INCLUDE and use -D PKG_GEARQUAT=on.")
endif()

# LAMMPS collects the headers of all fix styles in the global property FIX and writes style_fix.h
# once from it. Being in the list beforehand writes that file once, not twice: modify.cpp is not
# compiled again after every configure.
set_property(GLOBAL APPEND PROPERTY FIX ${GEARQUAT_STYLES})

function(gearquat_add_to_lammps)
  file(STRINGS "${LAMMPS_STYLE_HEADERS_DIR}/style_fix.h" listed REGEX "fix_gear_quat\\.h")
  if(NOT listed)
    # an LAMMPS that gathers its styles in another way
    RegisterStyles(${GEARQUAT_FOLDER})
    GenerateStyleHeaders(${LAMMPS_STYLE_HEADERS_DIR})
  endif()

  target_sources(lammps PRIVATE ${GEARQUAT_SOURCES})
  # Only these see the style header. Everything else compiles as without us, so that a
  # compiler cache serves every checkout.
  set_source_files_properties("${LAMMPS_SOURCE_DIR}/modify.cpp" "${LAMMPS_SOURCE_DIR}/lammps.cpp"
    ${GEARQUAT_SOURCES}
    PROPERTIES INCLUDE_DIRECTORIES "${GEARQUAT_FOLDER}")
  if(GEARQUAT_CHECKS)
    set_property(SOURCE ${GEARQUAT_SOURCES} APPEND PROPERTY COMPILE_DEFINITIONS GEARQUAT_CHECKS)
  endif()

  if(GEARQUAT_PRECOMPILE_HEADERS)
    target_precompile_headers(lammps PRIVATE
      <mpi.h> <cmath> <cstdio> <cstring> <map> <string> <vector>
      "${LAMMPS_SOURCE_DIR}/atom.h" "${LAMMPS_SOURCE_DIR}/comm.h" "${LAMMPS_SOURCE_DIR}/compute.h"
      "${LAMMPS_SOURCE_DIR}/domain.h" "${LAMMPS_SOURCE_DIR}/error.h" "${LAMMPS_SOURCE_DIR}/fix.h"
      "${LAMMPS_SOURCE_DIR}/force.h" "${LAMMPS_SOURCE_DIR}/group.h" "${LAMMPS_SOURCE_DIR}/memory.h"
      "${LAMMPS_SOURCE_DIR}/modify.h" "${LAMMPS_SOURCE_DIR}/neighbor.h"
      "${LAMMPS_SOURCE_DIR}/neigh_list.h" "${LAMMPS_SOURCE_DIR}/pair.h"
      "${LAMMPS_SOURCE_DIR}/update.h")
    # our own sources have to name every header they use
    set_source_files_properties(${GEARQUAT_SOURCES} PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
      # without it ccache cannot look into a precompiled header
      target_compile_options(lammps PRIVATE -fpch-preprocess)
    endif()
  endif()

  list(LENGTH GEARQUAT_SOURCES count)
  message(STATUS "GEARQUAT: ${count} sources from ${GEARQUAT_FOLDER}")
endfunction()
cmake_language(DEFER CALL gearquat_add_to_lammps)
