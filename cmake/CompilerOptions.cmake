# flexarm_options: warnings and sanitizers of our own sources; the floating point rules stay those of IEEE 754.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_CXX_VISIBILITY_PRESET hidden)
set(CMAKE_VISIBILITY_INLINES_HIDDEN ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

add_library(flexarm_options INTERFACE)
target_compile_options(flexarm_options INTERFACE -Wall -Wextra -Wpedantic -Wshadow)
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  target_compile_options(flexarm_options INTERFACE -Wno-maybe-uninitialized) # GCC 12 sees it in every Eigen matrix
endif()
if(FLEXARM_NATIVE)
  target_compile_options(flexarm_options INTERFACE -march=native)
endif()
if(FLEXARM_SANITIZE)
  target_compile_options(
    flexarm_options INTERFACE -fsanitize=${FLEXARM_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer
  )
  target_link_options(flexarm_options INTERFACE -fsanitize=${FLEXARM_SANITIZE})
  if(FLEXARM_SANITIZE MATCHES undefined)
    # These four double the compile time of Eigen; wrong pointers and sizes show in the address sanitizer too.
    target_compile_options(flexarm_options INTERFACE -fno-sanitize=null,alignment,object-size,vptr)
  endif()
endif()

# Libraries that nothing calls are left out of the link.
if(NOT APPLE AND NOT MSVC)
  add_link_options(-Wl,--as-needed)
endif()
