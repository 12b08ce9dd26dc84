# flexarm_suitesparse: KLU with AMD, COLAMD and BTF, and CHOLMOD, where SuiteSparse is present and wanted.
#   FLEXARM_HAS_KLU      KLU (LGPL) factorises the matrix of a step
#   FLEXARM_HAS_CHOLMOD  CHOLMOD (LGPL) orders solid parts, by METIS or AMD, for the factor in linear_solvers/. A library that
#                        also holds its supernodal part, which is not called, is GPL, and so is a build that links it;
#                        FLEXARM_SUITESPARSE=OFF keeps a build free of both
# That factor is as fast as the BLAS on which CHOLMOD depends (libopenblas-dev); nothing here links a BLAS.
# SuiteSparse 7 brings CMake packages, SuiteSparse 5 (Debian 12) only headers and libraries.
add_library(flexarm_suitesparse INTERFACE)
set(FLEXARM_HAS_KLU OFF)
set(FLEXARM_HAS_CHOLMOD OFF)
set(SUITESPARSE_VERSION "")
if(NOT FLEXARM_SUITESPARSE MATCHES "^(AUTO|SYSTEM|OFF)$")
  message(FATAL_ERROR "FLEXARM_SUITESPARSE must be AUTO, SYSTEM or OFF, got '${FLEXARM_SUITESPARSE}'")
endif()

# Sets <name>_target to a library that carries its include folder, or to NOTFOUND.
function(find_suitesparse_part name header)
  set(target NOTFOUND)
  string(TOLOWER ${name} library)
  find_path(FLEXARM_${name}_INCLUDE ${header} PATH_SUFFIXES suitesparse)
  find_library(FLEXARM_${name}_LIBRARY ${library})
  mark_as_advanced(FLEXARM_${name}_INCLUDE FLEXARM_${name}_LIBRARY)
  if(TARGET SuiteSparse::${name})
    set(target SuiteSparse::${name})
  elseif(FLEXARM_${name}_INCLUDE AND FLEXARM_${name}_LIBRARY)
    set(target flexarm_${library})
    add_library(${target} INTERFACE)
    target_include_directories(${target} SYSTEM INTERFACE ${FLEXARM_${name}_INCLUDE})
    target_link_libraries(${target} INTERFACE ${FLEXARM_${name}_LIBRARY})
  endif()
  set(${name}_target ${target} PARENT_SCOPE)
endfunction()

function(read_suitesparse_version)
  find_file(SUITESPARSE_CONFIG_HEADER SuiteSparse_config.h PATH_SUFFIXES suitesparse)
  mark_as_advanced(SUITESPARSE_CONFIG_HEADER)
  if(SUITESPARSE_CONFIG_HEADER)
    foreach(part MAIN SUB SUBSUB)
      file(STRINGS ${SUITESPARSE_CONFIG_HEADER} line REGEX "#define SUITESPARSE_${part}_VERSION ")
      string(REGEX MATCH "[0-9]+" ${part} "${line}")
    endforeach()
    set(SUITESPARSE_VERSION ${MAIN}.${SUB}.${SUBSUB} PARENT_SCOPE)
  endif()
endfunction()

if(NOT FLEXARM_SUITESPARSE STREQUAL OFF)
  enable_language(C) # the packages of SuiteSparse 7 look for OpenMP in C
  find_package(KLU CONFIG QUIET) # with AMD, COLAMD, BTF and SuiteSparseConfig
  find_package(CHOLMOD CONFIG QUIET)
  find_suitesparse_part(SuiteSparseConfig SuiteSparse_config.h)
  find_suitesparse_part(KLU klu.h)
  find_suitesparse_part(AMD amd.h)
  find_suitesparse_part(COLAMD colamd.h)
  find_suitesparse_part(BTF btf.h)
  find_suitesparse_part(CHOLMOD cholmod.h)
  if(KLU_target AND AMD_target AND COLAMD_target AND BTF_target AND SuiteSparseConfig_target)
    set(FLEXARM_HAS_KLU ON)
    target_link_libraries(
      flexarm_suitesparse
      INTERFACE ${KLU_target} ${BTF_target} ${COLAMD_target} ${AMD_target} ${SuiteSparseConfig_target}
    )
    target_compile_definitions(flexarm_suitesparse INTERFACE FLEXARM_HAS_KLU=1)
  endif()
  if(CHOLMOD_target)
    set(FLEXARM_HAS_CHOLMOD ON)
    target_link_libraries(flexarm_suitesparse INTERFACE ${CHOLMOD_target} ${CMAKE_DL_LIBS})
    target_compile_definitions(flexarm_suitesparse INTERFACE FLEXARM_HAS_CHOLMOD=1)
  endif()
  read_suitesparse_version()
endif()

if(FLEXARM_SUITESPARSE STREQUAL SYSTEM AND NOT (FLEXARM_HAS_KLU AND FLEXARM_HAS_CHOLMOD))
  message(FATAL_ERROR "FLEXARM_SUITESPARSE=SYSTEM, but KLU or CHOLMOD is missing: apt-get install libsuitesparse-dev")
endif()
message(STATUS "SuiteSparse ${SUITESPARSE_VERSION}: KLU ${FLEXARM_HAS_KLU}, CHOLMOD ${FLEXARM_HAS_CHOLMOD} (Eigen stands in)")
