# Everything comes from installed packages; nothing is downloaded.

find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(TBB REQUIRED)
find_package(fmt REQUIRED)
find_package(spdlog REQUIRED)
find_package(tomlplusplus REQUIRED)
find_package(nlohmann_json REQUIRED)
if(RESILIN_WITH_PETSC)
  find_package(PkgConfig REQUIRED)
  find_package(MPI REQUIRED COMPONENTS CXX)
  pkg_check_modules(PETSC REQUIRED PETSc>=3.18)  # Debian: libpetsc-real-dev
endif()
if(RESILIN_WITH_CHOLMOD)
  include(ResilinCholmod)
endif()
