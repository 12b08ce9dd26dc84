# flexarm_tests: one executable, one ctest entry for each file cpp/tests/**/*_test.cpp.
find_package(doctest REQUIRED)

file(GLOB_RECURSE test_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/cpp/tests/*_test.cpp)
add_executable(flexarm_tests ${PROJECT_SOURCE_DIR}/cpp/tests/main.cpp ${test_sources})
target_link_libraries(flexarm_tests PRIVATE flexarm_core flexarm_options doctest::doctest)
target_include_directories(flexarm_tests PRIVATE ${PROJECT_SOURCE_DIR}/cpp/tests)
if(FLEXARM_PCH)
  target_precompile_headers(flexarm_tests REUSE_FROM flexarm_core)
endif()

foreach(source IN LISTS test_sources)
  file(RELATIVE_PATH name ${PROJECT_SOURCE_DIR}/cpp/tests ${source})
  string(REGEX REPLACE "_test\\.cpp$" "" name ${name})
  add_test(NAME ${name} COMMAND flexarm_tests --source-file=*cpp/tests/${name}_test.cpp)
  # A file without test cases would pass silently.
  set_tests_properties(${name} PROPERTIES FAIL_REGULAR_EXPRESSION "test cases: +0 ")
endforeach()
