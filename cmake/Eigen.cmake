# flexarm_eigen and EIGEN_VERSION: Eigen 3.4 of the system, else the headers of the PyPI package cmeel-eigen.
find_package(Eigen3 3.4 QUIET NO_MODULE)
if(Eigen3_FOUND)
  get_target_property(eigen_include Eigen3::Eigen INTERFACE_INCLUDE_DIRECTORIES)
  set(eigen_origin "system")
else()
  find_package(Python 3.11 REQUIRED COMPONENTS Interpreter)
  execute_process(
    COMMAND ${Python_EXECUTABLE} -c "import sys; print(';'.join(p for p in sys.path if p))"
    OUTPUT_VARIABLE python_path OUTPUT_STRIP_TRAILING_WHITESPACE
  )
  unset(eigen_include CACHE) # an isolated build has another Python path every time
  find_path(
    eigen_include Eigen/Core
    PATHS ${python_path} PATH_SUFFIXES cmeel.prefix/include/eigen3 NO_DEFAULT_PATH
  )
  set(eigen_origin "PyPI, cmeel-eigen")
endif()
if(NOT eigen_include)
  message(FATAL_ERROR "Eigen 3.4 is missing: apt-get install libeigen3-dev, or pip install cmeel-eigen")
endif()

set(eigen_macros ${eigen_include}/Eigen/src/Core/util/Macros.h)
foreach(part WORLD MAJOR MINOR)
  file(STRINGS ${eigen_macros} line REGEX "#define EIGEN_${part}_VERSION ")
  string(REGEX MATCH "[0-9]+" eigen_${part} "${line}")
endforeach()
set(EIGEN_VERSION ${eigen_WORLD}.${eigen_MAJOR}.${eigen_MINOR})
message(STATUS "Eigen ${EIGEN_VERSION} (${eigen_origin})")

add_library(flexarm_eigen INTERFACE)
target_include_directories(flexarm_eigen SYSTEM INTERFACE ${eigen_include})
target_compile_definitions(flexarm_eigen INTERFACE EIGEN_MPL2_ONLY) # Eigen's few LGPL files stay out
