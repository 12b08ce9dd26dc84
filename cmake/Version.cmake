# FLEXARM_VERSION as stated in pyproject.toml, the one place that holds it.
set(pyproject ${CMAKE_CURRENT_SOURCE_DIR}/pyproject.toml)
file(STRINGS ${pyproject} version_line REGEX "^version *= *\"[0-9.]+\"")
string(REGEX MATCH "[0-9]+\\.[0-9]+\\.[0-9]+" FLEXARM_VERSION "${version_line}")
if(NOT FLEXARM_VERSION)
  message(FATAL_ERROR "pyproject.toml states no version of the form 1.2.3")
endif()
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${pyproject})
