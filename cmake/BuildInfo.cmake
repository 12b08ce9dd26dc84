# flexarm/build_config.hpp. A build in the checkout asks git at run time instead, where the answer stays current.
set(FLEXARM_GIT "")
find_program(GIT_EXECUTABLE git)
mark_as_advanced(GIT_EXECUTABLE)
if(GIT_EXECUTABLE AND NOT FLEXARM_INPLACE AND EXISTS ${PROJECT_SOURCE_DIR}/.git)
  execute_process(
    COMMAND ${GIT_EXECUTABLE} describe --always --dirty --abbrev=12
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR} OUTPUT_VARIABLE FLEXARM_GIT OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET
  )
endif()
configure_file(
  ${PROJECT_SOURCE_DIR}/cmake/build_config.hpp.in ${PROJECT_BINARY_DIR}/generated/flexarm/build_config.hpp @ONLY
)
