# flexarm_tests: one executable, one ctest entry for each file cpp/tests/**/*_test.cpp; flexarm_tests_eigen: the same
# tests without SuiteSparse (FLEXARM_TEST_EIGEN), their names after "eigen/".
find_package(doctest REQUIRED)

file(GLOB_RECURSE test_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/cpp/tests/*.cpp)
add_library(flexarm_test_objects OBJECT ${test_sources})
target_link_libraries(flexarm_test_objects PRIVATE flexarm_common flexarm_options doctest::doctest)
# Each test file has a namespace of its own, so that several compile as one.
set_target_properties(flexarm_test_objects PROPERTIES UNITY_BUILD_BATCH_SIZE 6)
set_source_files_properties(${PROJECT_SOURCE_DIR}/cpp/tests/main.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
target_include_directories(flexarm_test_objects PRIVATE ${PROJECT_SOURCE_DIR}/cpp/tests)
# A fifth to a third less to compile; the library that they test keeps its own options.
target_compile_options(flexarm_test_objects PRIVATE $<$<AND:$<CONFIG:Release>,$<CXX_COMPILER_ID:GNU,Clang>>:-O1>)
target_precompile_headers(flexarm_test_objects REUSE_FROM flexarm_common)

# add_tests(executable core [prefix of the names])
function(add_tests executable core)
  add_executable(${executable} $<TARGET_OBJECTS:flexarm_test_objects>)
  target_link_libraries(${executable} PRIVATE ${core} flexarm_options doctest::doctest)
  foreach(source IN LISTS test_sources)
    file(RELATIVE_PATH name ${PROJECT_SOURCE_DIR}/cpp/tests ${source})
    if(name MATCHES "^(.*)_test\\.cpp$")
      set(test ${ARGN}${CMAKE_MATCH_1})
      add_test(NAME ${test} COMMAND ${executable} --source-file=*cpp/tests/${name})
      # A file without test cases would pass silently.
      set_tests_properties(${test} PROPERTIES FAIL_REGULAR_EXPRESSION "test cases: +0 ")
    endif()
  endforeach()
endfunction()

add_tests(flexarm_tests flexarm_core)
if(FLEXARM_TEST_EIGEN)
  add_tests(flexarm_tests_eigen flexarm_core_eigen eigen/)
endif()

if(lane_sources)
  set(kernels $<FILTER:$<TARGET_OBJECTS:flexarm_common>,INCLUDE,/lanes/kernel_avx>)
  add_test(
    NAME lanes/own_names
    COMMAND ${CMAKE_COMMAND} -D NM=${CMAKE_NM} -D "OBJECTS=$<JOIN:${kernels},,>" -D TAG=Avx
            -P ${PROJECT_SOURCE_DIR}/cmake/own_names.cmake
  )
endif()
