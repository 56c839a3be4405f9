# Copyright Spack Project Developers. See COPYRIGHT file for details.
#
# SPDX-License-Identifier: (Apache-2.0 OR MIT)

import datetime as dt

from spack_repo.builtin.build_systems.cmake import CMakePackage

from spack.package import *


class LammpsGearquat(CMakePackage):
    """Plugin for LAMMPS with fix gear/quat, which integrates rigid bodies by Gear's
    predictor-corrector in quaternions."""

    # FILL IN: homepage, git, and for each release a version with its sha256
    homepage = "https://www.lammps.org"
    git = "file:///path/to/gearquat"

    license("GPL-2.0-only")

    version("main", branch="main")

    depends_on("cxx", type="build")
    depends_on("cmake@3.18:", type="build")
    # The plugin is compiled with the headers and the MPI of this very LAMMPS, and fits no other.
    depends_on("lammps@20250204: +lib+plugin+mpi", type=("build", "link", "run"))
    depends_on("mpi")

    conflicts("^lammps@develop", msg="the date of LAMMPS is not known from its version")
    conflicts("^lammps lammps_sizes=smallsmall", msg="LAMMPS has smallbig or bigbig")

    def cmake_args(self):
        lammps = self.spec["lammps"]
        # 20250722.3 is 22 Jul 2025, update 3
        date = dt.datetime.strptime(str(lammps.version.up_to(1)), "%Y%m%d")
        sizes = lammps.variants["lammps_sizes"].value
        return [
            self.define("LAMMPS_SOURCE_DIR", lammps.prefix),
            self.define("LAMMPS_VERSION", date.strftime("%d %b %Y").lstrip("0")),
            self.define("LAMMPS_SIZES", sizes),
            self.define("MPI_CXX_COMPILER", self.spec["mpi"].mpicxx),
        ]

    def setup_run_environment(self, env):
        for folder in (self.prefix.lib, self.prefix.lib64):
            env.prepend_path("LAMMPS_PLUGIN_PATH", folder.lammps.plugins)
