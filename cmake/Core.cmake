# flexarm_core: the finite elements, no Python.
# flexarm_core_eigen: the same without SuiteSparse, for tests (FLEXARM_TEST_EIGEN). Only `backend_sources` know
# which library factorises; all others are compiled once, as flexarm_common.
file(GLOB_RECURSE core_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/cpp/src/*.cpp)
set(backend_sources build_info linear_solvers/blas_info linear_solvers/fill_ordering linear_solvers/sparse_factor)
list(TRANSFORM backend_sources PREPEND ${PROJECT_SOURCE_DIR}/cpp/src/)
list(TRANSFORM backend_sources APPEND .cpp)
list(REMOVE_ITEM core_sources ${backend_sources})

# Code of arms side by side is compiled once for each kind of processor and chosen when it runs. It shares no function
# with other code, or the linker might take one for every processor; so it takes no precompiled header either. Builds
# for debugging and sanitizers leave functions out of line that all code shares: there arms run alone.
set(lane_sources "")
if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64|amd64)$" AND CMAKE_CXX_COMPILER_ID MATCHES "^(GNU|Clang)$"
   AND CMAKE_BUILD_TYPE MATCHES "^Rel" AND NOT FLEXARM_SANITIZE)
  set(avx2 -mavx2 -mfma)
  set(avx512 -mavx512f -mavx512dq -mavx512vl -mfma -mprefer-vector-width=512)
  foreach(processor avx2 avx512)
    set(source ${PROJECT_SOURCE_DIR}/cpp/src/lanes/kernel_${processor}.cpp)
    list(APPEND lane_sources ${source})
    set_source_files_properties(
      ${source} PROPERTIES SKIP_PRECOMPILE_HEADERS ON COMPILE_DEFINITIONS "EIGEN_DONT_VECTORIZE;EIGEN_NO_DEBUG"
      COMPILE_OPTIONS "${${processor}};-O3;-ffp-contract=fast"
    )
  endforeach()
  set_source_files_properties(
    ${PROJECT_SOURCE_DIR}/cpp/src/lanes/kernel.cpp PROPERTIES COMPILE_DEFINITIONS FLEXARM_LANES
  )
endif()
list(FILTER core_sources EXCLUDE REGEX "/lanes/kernel_[a-z0-9]+[.]cpp$")
list(REVERSE core_sources) # Ninja begins with the last: the assembly, which takes longest

add_library(flexarm_common OBJECT ${core_sources} ${lane_sources})
target_include_directories(
  flexarm_common PUBLIC ${PROJECT_SOURCE_DIR}/cpp/include PRIVATE ${PROJECT_BINARY_DIR}/generated
)
target_link_libraries(flexarm_common PUBLIC flexarm_eigen flexarm_suitesparse Threads::Threads PRIVATE flexarm_options)
target_precompile_headers(
  flexarm_common PRIVATE <Eigen/Dense> <Eigen/SparseCore> <functional> <string> <vector> <flexarm/model/arm.hpp>
)
set(CMAKE_CXX_COMPILE_OPTIONS_PIE -fPIC) # as in flexarm_common, so that the tests can read what it precompiled

# add_core(name [libraries that factorise])
function(add_core name)
  add_library(${name} STATIC ${backend_sources} $<TARGET_OBJECTS:flexarm_common>)
  target_include_directories(${name} PUBLIC ${PROJECT_SOURCE_DIR}/cpp/include PRIVATE ${PROJECT_BINARY_DIR}/generated)
  target_link_libraries(${name} PUBLIC flexarm_eigen Threads::Threads ${ARGN} PRIVATE flexarm_options)
endfunction()

add_core(flexarm_core flexarm_suitesparse)
if(FLEXARM_TEST_EIGEN)
  add_core(flexarm_core_eigen)
endif()
