# flexarm._core, the private Python module.
find_package(Python 3.11 REQUIRED COMPONENTS Interpreter Development.Module)
set(PYBIND11_FINDPYTHON ON)
execute_process(
  COMMAND ${Python_EXECUTABLE} -m pybind11 --cmakedir
  OUTPUT_VARIABLE pybind11_ROOT OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET
)
find_package(pybind11 3.0.4 CONFIG REQUIRED)

file(GLOB binding_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/cpp/bindings/*.cpp)
pybind11_add_module(_core NO_EXTRAS ${binding_sources})
target_link_libraries(_core PRIVATE flexarm_core flexarm_options)
# The bindings only convert and call: optimising them doubles their compile time for nothing.
target_compile_options(_core PRIVATE $<$<AND:$<CONFIG:Release>,$<CXX_COMPILER_ID:GNU,Clang>>:-O1>)
set_target_properties(_core PROPERTIES UNITY_BUILD_BATCH_SIZE 5) # two halves, compiled last on two cores
target_precompile_headers(_core PRIVATE <pybind11/eigen.h> <pybind11/numpy.h> <pybind11/stl.h> <Eigen/Dense> <Eigen/SparseCore>)
if(FLEXARM_INPLACE)
  set_target_properties(_core PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${PROJECT_SOURCE_DIR}/python/flexarm)
endif()
install(TARGETS _core LIBRARY DESTINATION flexarm)
