# cmake -DNM=nm -DOBJECTS=a.o,b.o -DTAG=Avx -P own_names.cmake: every function that the linker may merge with those of
# other objects has the tag in its name; else code for one processor could be taken for all.
string(REPLACE "," ";" OBJECTS "${OBJECTS}")
foreach(object IN LISTS OBJECTS)
  execute_process(COMMAND ${NM} --defined-only ${object} OUTPUT_VARIABLE names COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX MATCHALL "[^\n]* [WVu] [^\n]*" shared "${names}")
  list(FILTER shared EXCLUDE REGEX "${TAG}")
  if(shared)
    message(FATAL_ERROR "${object} shares names with other code: ${shared}")
  endif()
endforeach()
